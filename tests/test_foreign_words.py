"""The saved outputs of every chapter have no words of a program that was in its domain by chance."""

from __future__ import annotations

import subprocess
from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook, new_output

from tests.chapters import PATHS, cells
from tests.foreign_words import foreign_lines, foreign_names, made_by, shown
from tests.test_notebooks import NBVAL

TALKER = 'talker.publish(String(data=f"Hello ROS 2: {count}"))'
HEARD = "  [INFO] [1795268389.714431233] [{}]: I heard: {}: 10"


@pytest.mark.parametrize("path", PATHS, ids=[path.stem for path in PATHS])
def test_all_names_and_lines_in_saved_outputs_can_come_from_the_chapter(path: Path) -> None:
    made = made_by(cells(path))
    for cell in cells(path):
        for text in shown(cell) if cell.cell_type == "code" else ():
            foreign = foreign_names(text, made) + foreign_lines(text, made)
            assert not foreign, f"{cell.id} has saved {foreign[:3]}: save it in a domain with nothing else in it"


def test_foreign_names_and_lines_are_found() -> None:
    made = made_by([new_code_cell(f'run(Listener("listener"), name="fibonacci_client"); say("I heard"); {TALKER}')])
    assert foreign_names("/listener\n/fibonacci_client\n/turtle1/color_sensor\n/home/me/x.py", made) == []
    assert foreign_names("/listener\n/stranger\n/listener/stray", made) == ["/listener/stray", "/stranger"]
    assert foreign_names(HEARD.format("kitchen.listener", "Hello"), made) == ["kitchen.listener"]
    assert foreign_lines(HEARD.format("listener", "Hello ROS 2"), made) == []
    assert foreign_lines(HEARD.format("listener", "Hello ROS2"), made) == ["I heard: Hello ROS2: 10"]


@pytest.mark.parametrize(("saved", "status"), [("/listener\n", 0), ("/listener\n/talker\n", 1)])
def test_a_node_that_is_not_there_when_the_chapter_runs_is_found(saved: str, status: int, tmp_path: Path) -> None:
    output = new_output("stream", name="stdout", text=saved)
    looks = new_code_cell("%ros2 node list", id="chapter-look", execution_count=2, outputs=[output])
    begins = new_code_cell("from course_kit import run\nfrom rclpy.node import Node", id="chapter-begin")
    runs = new_code_cell("listener = run(Node, 'listener')", id="chapter-run")
    notebook = new_notebook(cells=[begins, runs, looks])
    for number, cell in enumerate(notebook.cells, 1):
        cell.execution_count = number
        cell.metadata.tags = ["nbval-ignore-output"]
    nbformat.write(notebook, tmp_path / "chapter.ipynb")
    command = [*NBVAL, "-p", "tests.foreign_words", "chapter.ipynb"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=110)
    assert done.returncode == status, done.stdout[-3000:]
    assert ("chapter-look has saved /talker" in done.stdout) == bool(status)
