"""Packages of earlier chapters: the same as the chapter's own, and built where the chapter was not run."""

from __future__ import annotations

import subprocess
from pathlib import Path

import nbformat
import pytest

from course_kit.setup.colcon import chapter_packages
from course_kit.setup.colcon.workspaces import Workspace

NOTEBOOK = Path(__file__).parents[1] / "notebooks/02_workspace.ipynb"
WRITES = "%%writefile ros2_ws/src/my_interfaces/"


def test_my_interfaces_is_what_chapter_2_writes():
    cells = [cell.source for cell in nbformat.read(NOTEBOOK, as_version=4).cells if cell.source.startswith(WRITES)]
    written = {head.removeprefix(WRITES): body for head, _, body in (source.partition("\n") for source in cells)}
    folder = chapter_packages.FOLDER / "my_interfaces"
    files = {str(path.relative_to(folder)): path for path in folder.rglob("*") if path.is_file()}
    assert {name: path.read_text().strip() for name, path in files.items()} == {
        name: body.strip() for name, body in written.items()
    }


@pytest.mark.slow("chapters 4 and 5 build the package too")
@pytest.mark.timeout(300)  # a build, maybe beside others
def test_a_package_is_built_once_and_then_left_as_it_is(tmp_path, capfd, monkeypatch):
    monkeypatch.setattr(Workspace, "use", lambda workspace: None)  # it would change this process for all other tests
    workspace = Workspace(tmp_path / "ros2_ws")
    chapter_packages.provide(workspace, "my_interfaces")
    assert "is now in ros2_ws/src" in capfd.readouterr().out
    command = ["python3", "-c", "from my_interfaces.action import Polygon; print(Polygon.Goal().sides)"]
    used = subprocess.run(command, env=workspace.environment, capture_output=True, text=True, timeout=60)
    assert used.stdout == "5\n", used.stderr
    note = workspace.src / "my_interfaces/note.txt"
    note.write_text("mine")
    chapter_packages.provide(workspace, "my_interfaces")
    assert capfd.readouterr().out == ""
    assert note.read_text() == "mine"


def test_a_package_that_no_chapter_makes_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"only my_interfaces$"):
        chapter_packages.provide(Workspace(tmp_path / "ros2_ws"), "my_interface")
