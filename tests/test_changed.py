"""Which groups of tests a change can break."""

from __future__ import annotations

import pytest

from tests import landings
from tests.changed import CHOOSING, Dependencies


@pytest.fixture(scope="module")
def dependencies() -> Dependencies:
    return Dependencies()


def test_each_file_of_the_course_is_some_test_s(dependencies: Dependencies) -> None:
    files = landings.git("ls-files", "course_kit", "notebooks", "tests")
    if not files:
        pytest.skip("this copy of the course is no git repository")
    assert {file for file in files if not dependencies.touched(file)} == CHOOSING & {*files}


@pytest.mark.parametrize(
    ("file", "module"),
    [
        ("course_kit/robots/robot/vehicle.py", "course_kit.robots.robot.vehicle"),
        ("notebooks/03_topics.ipynb", "notebooks.03_topics"),
        ("course_kit/views/live/form.js", "course_kit.views.live.form"),
        ("tests/programs/storm.py", "tests.test_dead_segments"),
    ],
)
def test_a_file_touches_what_it_is_or_what_names_it(dependencies: Dependencies, file: str, module: str) -> None:
    assert module in dependencies.touched(file)


def test_what_each_landing_changes_brings_no_group_near(dependencies: Dependencies) -> None:
    assert set(dependencies.distances(CHOOSING).values()) == {None}


def test_a_group_is_nearer_the_fewer_imports_lie_between(dependencies: Dependencies) -> None:
    found = dependencies.distances(["course_kit/exercises/robot/solutions/robot-8.md"])
    assert found["exercise robot-8"] == 0
    assert found["exercise topics-1"] is None
    found = dependencies.distances(["course_kit/robots/navigation/planning.py"])
    assert found["test_navigation_paths"] == 1
    assert found["test_conversations"] is None
    assert found["07_robot"] is not None
