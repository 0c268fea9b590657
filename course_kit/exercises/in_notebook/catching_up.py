"""catch_up() in a notebook: after a restart of the kernel, what a chapter has defined so far is there again."""

from __future__ import annotations

import ast
import contextlib
import io
from collections.abc import Iterator
from typing import Any

import nbformat

from course_kit.base import kernel
from course_kit.base.arguments import TEXT, takes
from course_kit.base.long_tasks import long_task
from course_kit.exercises.notebooks.definitions import definitions
from course_kit.exercises.notebooks.reference import Chapter, chapters, mark_of, prerequisites


@takes(cell=TEXT)
def catch_up(cell: str) -> None:
    """Run what a chapter defines above a cell, such as `catch_up("topics-square")`, if this kernel does not have it.

    That is the imports, functions, classes and constants of the chapter as the course has it, and what it has built in
    its workspace. What you have defined meanwhile stays as it is; nodes, recordings and programs are not started.
    Raises ValueError if no chapter has such a cell, RuntimeError outside a notebook.
    """
    above = list(_above(cell))
    shell = kernel.shell()
    if shell is None:
        raise RuntimeError("catch_up works only in a notebook: in a program, import what you need")
    there = frozenset(shell.user_ns)
    missing = {each.id: _missing(each.source, there) for each in above}
    if not any(missing.values()):
        print("Nothing to catch up on: all that stands above is defined.")
        return
    # A cell that does something may undo what another one has done: so all of those are run.
    sources = {each.id: each.source if mark_of(each)["part"] == "whole" else missing[each.id] for each in above}
    wanted = {name: source for name, source in sources.items() if source}
    with long_task("catching up", len(wanted), "cells") as task:
        for done, (name, source) in enumerate(wanted.items()):
            task.done = done
            _run(shell, name, source)
    print(f"Caught up: {len(wanted)} of the cells above have run again, as the course has them.")


def _above(cell: str) -> Iterator[nbformat.NotebookNode]:
    """The cells above it that others build on."""
    named = (chapter for chapter in chapters() if f'"{cell}"' in chapter.text)  # to parse no other
    chapter: Chapter | None = next((chapter for chapter in named if cell in chapter.ids), None)
    if chapter is None:
        raise ValueError(f"no chapter has a cell {cell!r}: call catch_up as the chapter does, at a place to stop")
    above = set(chapter.order[: chapter.order.index(cell)])
    yield from (each for each in prerequisites(chapter) if each.id in above)


def _missing(source: str, there: frozenset[str]) -> str:
    """The definitions of a cell whose names are not all there; all of them with their comments, or some without."""
    source = definitions(source)
    body = ast.parse(source).body
    wanted = [statement for statement in body if not _names(statement) <= there]
    return source if len(wanted) == len(body) else "\n".join(map(ast.unparse, wanted))


def _names(statement: ast.stmt) -> set[str]:
    """What a definition calls something, and what it needs for that."""
    match statement:
        case ast.Import(names=imported) | ast.ImportFrom(names=imported):
            return {(one.asname or one.name).split(".")[0] for one in imported}
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
            return {name}
    return {one.id for one in ast.walk(statement) if isinstance(one, ast.Name)}


def _run(shell: Any, name: str, source: str) -> None:
    """Run a cell without what it prints. RuntimeError if it fails, with its traceback shown."""
    with contextlib.redirect_stdout(io.StringIO()):
        result = shell.run_cell(source, silent=True)
    if not result.success:
        raise RuntimeError(f"catch_up stopped at the cell {name}, which failed as shown above: run it by hand")
