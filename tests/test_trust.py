"""Which notebooks `lab` has JupyterLab trust: those that are as the course has them."""

from __future__ import annotations

import json
import shutil
import subprocess
from hashlib import sha256
from pathlib import Path

import nbformat
import pytest
from nbformat.sign import NotebookNotary
from nbformat.v4 import new_code_cell, new_notebook, new_output

from course_kit.setup.environment.trust import sign

TOPICS = "03_topics.ipynb"


def notebook(html: str) -> str:
    output = new_output("display_data", data={"text/html": html})
    return nbformat.writes(new_notebook(cells=[new_code_cell("1", id="a", execution_count=1, outputs=[output])]))


@pytest.fixture
def course(tmp_path: Path) -> Path:
    """A course with one notebook; nothing knows yet that it is the course's."""
    root = tmp_path / "course"
    (root / "notebooks").mkdir(parents=True)
    (root / "notebooks" / TOPICS).write_text(notebook("<b>the course's</b>"))
    return root


@pytest.fixture
def clone(course: Path) -> Path:
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "a"]):
        subprocess.run([*git, *words], cwd=course, check=True, capture_output=True)
    return course


@pytest.fixture
def release(course: Path) -> Path:
    digest = sha256((course / "notebooks" / TOPICS).read_bytes()).hexdigest()
    (course / "manifest.json").write_text(json.dumps({"files": {f"notebooks/{TOPICS}": digest}}))
    return course


def trusted(path: Path, data: Path) -> bool:
    """As JupyterLab sees it that keeps its signatures there."""
    with NotebookNotary(data_dir=str(data)) as notary:
        return bool(notary.check_signature(nbformat.read(path, as_version=4)))


@pytest.mark.parametrize("kind", ["clone", "release"])
def test_a_notebook_of_the_course_is_trusted_until_somebody_changes_it(kind, request, tmp_path):
    root, data = request.getfixturevalue(kind), tmp_path / "data"
    path = root / "notebooks" / TOPICS
    assert sign(path.parent, root, data) == [TOPICS]
    assert trusted(path, data)
    path.write_text(notebook("<script>theirs()</script>"))
    assert sign(path.parent, root, data) == []
    assert not trusted(path, data)


def test_a_copy_elsewhere_is_trusted_under_its_name_only(clone, tmp_path):
    folder, data = tmp_path / "mine", tmp_path / "data"
    shutil.copytree(clone / "notebooks", folder)
    shutil.copy(folder / TOPICS, folder / "04_services.ipynb")
    assert sign(folder, clone, data) == [TOPICS]


def test_what_a_stranger_put_in_is_not_trusted(clone, tmp_path):
    stranger = clone / "notebooks/05_actions.ipynb"
    stranger.write_text(notebook("<script>theirs()</script>"))
    (clone / "notebooks/broken.ipynb").write_bytes(b"\xff{")
    assert sign(stranger.parent, clone, tmp_path / "data") == [TOPICS]
    assert not trusted(stranger, tmp_path / "data")


def test_where_nothing_tells_what_the_course_is_nothing_is_trusted(course, tmp_path):
    assert sign(course / "notebooks", course, tmp_path / "data") == []
    (course / "manifest.json").write_text('{"files": [')
    assert sign(course / "notebooks", course, tmp_path / "data") == []


def test_what_a_student_has_run_and_saved_stays_trusted(clone, tmp_path):
    path, data = clone / "notebooks" / TOPICS, tmp_path / "data"
    sign(path.parent, clone, data)
    path.write_text(notebook("<b>the student's</b>"))
    with NotebookNotary(data_dir=str(data)) as notary:  # as JupyterLab does when it saves
        notary.sign(nbformat.read(path, as_version=4))
    sign(path.parent, clone, data)
    assert trusted(path, data)
