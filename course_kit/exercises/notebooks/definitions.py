"""The definitions of a cell: its imports, functions, classes and constants, without what it does. Pure: no ROS."""

from __future__ import annotations

import ast
import threading

# Works are graded in threads, and Python before 3.12 mixes up how deep each of them has got in a source:
# "AST constructor recursion depth mismatch", CPython's issue 106905.
_parsing = threading.Lock()


def definitions(source: str) -> str:
    """The part of a cell that an answer may build on; nothing of a cell that only does something.

    That is imports, functions, classes, methods that are put into a class (`GoTo.steer = steer`), and names for plain
    values. A cell with a magic in its first line has none.
    """
    try:
        with _parsing:
            body = ast.parse(source).body
    except SyntaxError:
        return ""
    kept = [statement for statement in body if _defines(statement)]
    lines = source.splitlines()
    texts = []
    for statement in kept:
        first = min([statement.lineno, *(each.lineno for each in getattr(statement, "decorator_list", []))])
        texts.append("\n".join(lines[first - 1 : statement.end_lineno]))
    return "\n".join(texts)


def _defines(statement: ast.stmt) -> bool:
    match statement:
        case ast.Import() | ast.ImportFrom() | ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
            return True
        case ast.Assign(targets=targets, value=value):
            if all(isinstance(target, ast.Name) for target in targets):
                return _is_plain(value)
            return all(map(_are_methods, targets)) and _are_functions(value)
        case ast.AugAssign(target=ast.Name(), value=value):  # a text that goes on in a second cell
            return _is_plain(value)
    return False


def _is_plain(value: ast.expr) -> bool:
    try:
        ast.literal_eval(value)
    except ValueError:
        return False
    return True


def _are_methods(target: ast.expr) -> bool:
    """Return True if a target is `Class.method`, or several of them."""
    each = target.elts if isinstance(target, ast.Tuple) else [target]
    return all(isinstance(one, ast.Attribute) and isinstance(one.value, ast.Name) for one in each)


def _are_functions(value: ast.expr) -> bool:
    each = value.elts if isinstance(value, ast.Tuple) else [value]
    return all(isinstance(one, ast.Name | ast.Attribute) for one in each)
