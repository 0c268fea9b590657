"""The notebook that is graded: the course's own, with nothing but the answers taken from a hand-in. Pure: no ROS."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import nbformat

from course_kit.exercises.notebooks.reference import ANSWER, CHECK, EXERCISE, Chapter, is_untouched, prerequisites
from course_kit.exercises.protocol.verdict import points_text

LONGEST_ANSWER = 200_000  # characters
OUTPUT_VARIES = "nbval-ignore-output"
# What stands between the chapter's cells and the answers: the context that the demonstrations would have started, the
# course's `check`, which a chapter may have called something else, and that it shows only what does not vary.
START = """from course_kit import check
from course_kit.ros.spinning import context

context.start()"""
BEGIN = f"""from course_kit.exercises.in_notebook.check import show_points_only
{START}
show_points_only()"""


HANDED_IN = "handed_in"
# What an answer or the chapter makes itself would be in its way.
CREATED = r"\bpkg\s+create\s+(?:--?\S+\s+\S+\s+)*(\w+)"
BRING_IN = """import shutil

made_by_cells = {made}
shutil.copytree("{folder}", ws.src, dirs_exist_ok=True, ignore=shutil.ignore_patterns(*made_by_cells))
build = ws.build(check=False)"""


@dataclass(frozen=True)
class Answers:
    """What one notebook that was handed in answers: sources of cells by exercise, and what must be told about it."""

    sources: Mapping[str, str]
    notes: tuple[str, ...] = ()


def answers_of(data: bytes, name: str, chapter: Chapter) -> Answers:
    """The sources of the answer cells of a notebook, by their ids; whatever it is, it raises nothing.

    An untouched answer is left out: it was not begun.
    """
    try:
        cells = json.loads(data)["cells"]
        found = [(cell["id"], cell) for cell in cells if isinstance(cell, dict) and isinstance(cell.get("id"), str)]
    except (ValueError, KeyError, TypeError, RecursionError):
        return Answers({}, (f"{name} cannot be read as a notebook, so none of its answers counts.",))
    sources, notes = {}, []
    for task in chapter.tasks:
        own = chapter.cell(ANSWER, task.name)
        same = [cell for cell_id, cell in found if cell_id == own.id]
        problem = _problem(same)
        if problem:
            notes.append(f"{task.name}: {problem.format(cell=f'the answer cell {own.id} of {name}')}")
        elif not is_untouched(source := _source_of(same[0])):
            sources[task.name] = source
    added = [cell for cell_id, cell in found if cell_id not in chapter.ids and cell.get("cell_type") == "code"]
    if count := sum(bool((_source_of(cell) or "").strip()) for cell in added):
        cells_text = "1 cell of your own was" if count == 1 else f"{count} cells of your own were"
        notes.append(f"In {name}, {cells_text} left out: only what stands in the answer cells is graded.")
    return Answers(sources, tuple(notes))


def _problem(same: list[dict[str, Any]]) -> str:
    if not same:
        return "{cell} is missing."
    if len(same) > 1:
        return "{cell} is there " + f"{len(same)} times, so it cannot be told which counts."
    source = _source_of(same[0])
    if same[0].get("cell_type") != "code" or source is None:
        return "{cell} is no cell of code."
    if len(source) > LONGEST_ANSWER:
        return "{cell} is longer than " + f"{LONGEST_ANSWER:,} characters."
    return ""


def _source_of(cell: Mapping[str, Any]) -> Any:
    """The source, which is a text or the lines of one; None for what is neither."""
    source = cell.get("source")
    if isinstance(source, list) and all(isinstance(line, str) for line in source):
        source = "".join(source)
    return source.encode(errors="replace").decode() if isinstance(source, str) else None


def rebuilt(
    chapter: Chapter, sources: Mapping[str, str], only: Collection[str], has_workspace: bool = False
) -> nbformat.NotebookNode:
    """The notebook of these answers, with the checks of some; what a check shows for full points is saved in it.

    `has_workspace`: packages that were handed in lie in the folder HANDED_IN.
    """
    notebook = nbformat.v4.new_notebook(metadata={"kernelspec": chapter.notebook.metadata.kernelspec})
    cells = [*prerequisites(chapter), nbformat.v4.new_code_cell(BEGIN, id=f"{chapter.name}-begin")]
    if has_workspace:
        made = re.findall(CREATED, "\n".join([*sources.values(), *(cell.source for cell in cells)]))
        source = BRING_IN.format(folder=HANDED_IN, made=sorted(set(made)))
        cells.append(nbformat.v4.new_code_cell(source, id=f"{chapter.name}-handed-in"))
    for cell in cells:
        _unchecked(cell)
    last = max((number for number, task in enumerate(chapter.tasks) if task.name in only), default=-1)
    for task in chapter.tasks[: last + 1]:
        if task.name not in only and task.name not in sources:
            continue
        text, answer, check = (copy.deepcopy(chapter.cell(role, task.name)) for role in (EXERCISE, ANSWER, CHECK))
        answer.source = sources.get(task.name) or chapter.untouched(task.name)
        _unchecked(answer)
        cells += [text, answer]
        if task.name in only:
            full = f"{task.name} · {task.title}: {points_text(task.points, task.points)}"
            check.outputs = [nbformat.v4.new_output("stream", name="stdout", text=f"{full}\n")]
            cells.append(check)
    code = [cell for cell in cells if cell.cell_type == "code"]
    for count, cell in enumerate(code, 1):
        cell.execution_count = count
    notebook.cells = cells
    return notebook


def _unchecked(cell: nbformat.NotebookNode) -> None:
    """Let a cell's output be whatever it is."""
    cell.outputs = []
    cell.metadata["tags"] = [OUTPUT_VARIES]
