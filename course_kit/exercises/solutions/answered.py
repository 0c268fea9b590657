"""Reads the student's present answer from the notebook and its workspace. Pure: no ROS."""

from __future__ import annotations

import ast
import contextlib
from collections.abc import Iterator, Sequence
from typing import Any

from course_kit.base import kernel


def class_source(name: str, cells: Sequence[Any]) -> str | None:
    """The source of the class that the last of these cells defines by this name; None if none does."""
    return _source(name, cells, ast.ClassDef)


def function_source(name: str, cells: Sequence[Any]) -> str | None:
    """The same for a function; a method of a class is none."""
    return _source(name, cells, ast.FunctionDef)


def _source(name: str, cells: Sequence[Any], kind: type[ast.ClassDef | ast.FunctionDef]) -> str | None:
    for source in reversed(cells):
        if not isinstance(source, str) or name not in source:
            continue
        with contextlib.suppress(SyntaxError, ValueError, RecursionError):
            tree = ast.parse(source)
            found = [node for node in ast.walk(tree) if isinstance(node, kind) and node not in _methods(tree)]
            if same := [node for node in found if node.name == name]:
                return ast.get_source_segment(source, same[-1])
    return None


def _methods(tree: ast.AST) -> list[ast.stmt]:
    classes = (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef))
    return [node for each in classes for node in each.body if isinstance(node, ast.FunctionDef)]


def plain_values(source: str) -> Iterator[tuple[str, Any]]:
    """The names to which a source gives plain values, such as numbers and texts, and these values."""
    for statement in ast.parse(source).body:
        if not isinstance(statement, ast.Assign):
            continue
        (target, value) = statement.targets[0], statement.value
        pairs = [(target, value)]
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            pairs = list(zip(target.elts, value.elts, strict=False))
        for one, its in pairs:
            if isinstance(one, ast.Name):
                with contextlib.suppress(ValueError):
                    yield one.id, ast.literal_eval(its)


def cells_run() -> list[Any]:
    """The sources of the cells that have run in this kernel, as IPython keeps them."""
    shell = kernel.shell()
    return list(shell.history_manager.input_hist_parsed) if shell is not None else []
