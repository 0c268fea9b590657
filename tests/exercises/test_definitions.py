"""Definitions of types read as data: what counts, and the checker's own types in a student's order."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from course_kit.exercises.checker import own_types
from course_kit.exercises.checker.definitions import arranged, is_as_asked, shown
from tests.exercises.chapter import CHECK_TIMEOUT, Chapter, chapter, judge
from tests.exercises.workspace.workspace_4_battery import BATTERY, CHARGER, CHARGER_CLASS, RECHARGE, types
from tests.packages import write

pytestmark = [pytest.mark.cpu_bound, pytest.mark.by_turns("builds of packages")]

ANOTHER_ORDER = "bool charging\n\n# per cent\nfloat32 percentage 100.0\nfloat32 EMPTY_VOLTAGE = 11\nfloat32 voltage\n"
ANOTHER_ANSWER = "float32 percentage\n---\nstring reason\nbool accepted\n"
USE = """
import pathlib, sys
from course_kit.exercises.checker import own_types
own_types.base = lambda: pathlib.Path(sys.argv[1])
workspace = pathlib.Path(sys.argv[2])
own_types.provide("robot_interfaces", own_types.own_texts("robot_interfaces", workspace))
from robot_interfaces.msg import Battery
print(*Battery.get_fields_and_field_types())
try:
    own_types.provide("robot_interfaces")
except own_types.Uncompiled as error:
    print(error)
"""


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (BATTERY, BATTERY),
        (ANOTHER_ORDER, BATTERY),
        ("float32 FULL_VOLTAGE=12.6\n" + BATTERY, BATTERY),
        (ANOTHER_ANSWER, RECHARGE),
        ("float32   percentage\r\n--- # here\nbool accepted\nstring reason 'none'", RECHARGE),
    ],
)
def test_order_remarks_and_defaults_do_not_count(text: str, wanted: str) -> None:
    assert is_as_asked(text, wanted)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("", BATTERY),
        (BATTERY.replace("11.0", "11.5"), BATTERY),
        (BATTERY.replace("float32 EMPTY_VOLTAGE=11.0\n", ""), BATTERY),
        (BATTERY.replace("bool", "uint8"), BATTERY),
        (BATTERY + "float32 current\n", BATTERY),
        (BATTERY + "bool charging\n", BATTERY),
        ("float32 percentage\nbool accepted\n---\nstring reason\n", RECHARGE),
        ("float32 percentage\nbool accepted\nstring reason\n", RECHARGE),
        (RECHARGE.replace("string", "string<=20"), RECHARGE),
    ],
)
def test_types_names_and_constants_count(text: str, wanted: str) -> None:
    assert not is_as_asked(text, wanted)


def test_the_own_definition_is_arranged_as_another_one() -> None:
    assert arranged(ANOTHER_ORDER, BATTERY) == (
        "float32 EMPTY_VOLTAGE=11.0\nbool charging\nfloat32 percentage\nfloat32 voltage\n"
    )
    assert arranged(ANOTHER_ANSWER, RECHARGE) == ANOTHER_ANSWER
    assert shown(ANOTHER_ANSWER) == "float32 percentage / --- / string reason / bool accepted"


def test_what_is_not_as_asked_leaves_the_own_order(tmp_path: Path) -> None:
    write(tmp_path / "install/robot_interfaces/share/robot_interfaces", {"msg/Battery.msg": "string voltage\n"})
    asked = own_types.own_texts("robot_interfaces")
    assert own_types.own_texts("robot_interfaces", tmp_path) == own_types.own_texts("robot_interfaces", None) == asked


def test_own_types_are_compiled_in_the_order_that_is_installed(tmp_path: Path) -> None:
    files = {"msg/Battery.msg": ANOTHER_ORDER, "srv/Recharge.srv": ANOTHER_ANSWER}
    write(tmp_path / "ws/install/robot_interfaces/share/robot_interfaces", files)
    (tmp_path / "kept").mkdir()
    command = [sys.executable, "-c", USE, str(tmp_path / "kept"), str(tmp_path / "ws")]
    said = subprocess.run(command, capture_output=True, text=True, timeout=180).stdout.splitlines()
    assert said == ["charging percentage voltage", own_types.RELOAD.format(package="robot_interfaces")]


@pytest.fixture
def notebook():
    with chapter("workspace") as opened:
        yield opened


@pytest.mark.slow("two builds of a package of types, and one of the checker's own")
@pytest.mark.timeout(400)
def test_fields_in_another_order_are_right_and_stale_ones_are_named(notebook: Chapter) -> None:
    notebook.kernel.run(types(ANOTHER_ORDER, ANOTHER_ANSWER), 2 * CHECK_TIMEOUT)
    judge(notebook.answer("workspace-4", CHARGER_CLASS), 4, 4, "")
    shown = notebook.answer("workspace-4", CHARGER)  # built in the order of the text, and imported before
    assert "Restart the kernel" in shown
