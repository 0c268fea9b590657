"""Small changes of a program, each of which a student could have made: the operators of a mutation test. No ROS."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
ARITHMETIC: dict[type[ast.operator], tuple[type[ast.operator], ...]] = {
    ast.Add: (ast.Sub,),
    ast.Sub: (ast.Add,),
    ast.Mult: (ast.Div, ast.Add),
    ast.Div: (ast.Mult,),
    ast.Mod: (ast.FloorDiv,),
    ast.FloorDiv: (ast.Mod,),
}
SETTINGS = ("callback_group", "cancel_callback", "goal_callback", "feedback_callback", "timeout_sec", "timeout")
LONG = 160  # characters of a change that is shown
NOT_COUNTED = ("get_logger", "super")  # calls that are no behaviour of their own, or without which there is no node


@dataclass(frozen=True)
class Mutant:
    """A changed program, and in words what was changed."""

    change: str
    source: str


class Change(NamedTuple):
    """A change of a node of a copy of the program."""

    make: Callable[[ast.AST], None]
    words: str = ""  # what it is, where the line that differs does not show it


def mutants(source: str, only_classes: bool) -> list[Mutant]:
    """Every small change of a program, each once; with `only_classes` those of its classes, if it has any.

    Texts in it that are programs themselves are changed too.
    """
    tree = ast.parse(source)
    plain, found = ast.unparse(tree), {}
    has_classes = any(isinstance(one, ast.ClassDef) for one in tree.body)
    roots = [one for one in tree.body if isinstance(one, ast.ClassDef)] if only_classes and has_classes else [tree]
    wanted = {id(node) for root in roots for node in ast.walk(root)}
    for place, node in enumerate(ast.walk(tree)):
        if id(node) not in wanted or _is_plumbing(node):
            continue
        for change in _changes(node):
            mutated = copy.deepcopy(tree)
            change.make(list(ast.walk(mutated))[place])
            text = ast.unparse(ast.fix_missing_locations(mutated))
            if text != plain and text not in found and _compiles(text):
                found[text] = Mutant(change.words or _difference(plain, text), text)
    return list(found.values())


def _compiles(text: str) -> bool:
    try:
        compile(text, "<mutant>", "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
    except SyntaxError:
        return False
    return True


def _is_plumbing(node: ast.AST) -> bool:
    if isinstance(node, ast.Import | ast.ImportFrom | ast.alias):
        return True
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _difference(before: str, after: str) -> str:
    """The first line that differs, before and after."""
    old, new = before.splitlines(), after.splitlines()
    place = next((n for n, (a, b) in enumerate(zip(old, new, strict=False)) if a != b), min(len(old), len(new)))
    was = old[place].strip() if place < len(old) else ""
    if len(new) < len(old):
        return f"{place + 1}: {_cut(was)} left out"
    now = new[place].strip() if place < len(new) else ""
    if max(len(was), len(now)) > LONG:
        same = next((n for n, (a, b) in enumerate(zip(was, now, strict=False)) if a != b), 0)
        was, now = f"… {was[max(0, same - 60) :][:LONG]}", f"… {now[max(0, same - 60) :][:LONG]}"
    return f"{place + 1}: {was} -> {now}"


def _cut(line: str) -> str:
    return line if len(line) < LONG else f"{line[: LONG // 2]} … {line[-LONG // 2 :]}"


def _set(**fields: object) -> Change:
    def change(node: ast.AST) -> None:
        for name, value in fields.items():
            setattr(node, name, value)

    return Change(change)


def _changes(node: ast.AST) -> Iterator[Change]:
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        yield from (_set(ops=[op()]) for op in COMPARISONS[type(node.ops[0])])
    elif isinstance(node, ast.BinOp | ast.AugAssign):
        yield from (_set(op=op()) for op in ARITHMETIC.get(type(node.op), ()))
    elif isinstance(node, ast.BoolOp):
        yield _set(op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        yield Change(_without_operator)
    elif isinstance(node, ast.If | ast.IfExp | ast.While):
        if not isinstance(node, ast.While):
            yield _set(test=ast.Constant(True))
        yield _set(test=ast.Constant(False))
    elif isinstance(node, ast.Constant):
        yield from _constants(node)
    elif isinstance(node, ast.Call):
        yield from _calls(node)
    elif isinstance(node, ast.Await):
        yield Change(_without_await)
    if isinstance(node, ast.AST) and hasattr(node, "body") and isinstance(node.body, list):
        yield from _left_out(node)
    if isinstance(node, ast.If) and node.orelse and not isinstance(node.orelse[0], ast.If):
        yield _set(orelse=[])
    if isinstance(node, ast.Return) and node.value is not None:
        yield _set(value=None)
    if isinstance(node, ast.AugAssign):
        yield Change(_set_to_assignment)


def _constants(node: ast.Constant) -> Iterator[Change]:
    value = node.value
    if isinstance(value, bool):
        yield _set(value=not value)
    elif isinstance(value, int):
        yield from (_set(value=other) for other in {value + 1, value - 1, 0, 1} - {value} if other >= 0 or value < 0)
    elif isinstance(value, float):
        yield from (_set(value=other) for other in {value * 2, value / 2, value + 1.0} - {value})
    elif isinstance(value, str):
        inner = _program(value)
        if inner is not None:
            for mutant in mutants(value, only_classes=False):
                yield _set(value=mutant.source + "\n")._replace(words=f"in a file, {mutant.change}")
        elif len(value) < 60:
            yield _set(value=f"{value}_x" if value else "x")


def _program(text: str) -> ast.Module | None:
    if "\n" not in text or "import " not in text:
        return None
    try:
        return ast.parse(text)
    except SyntaxError:
        return None


def _calls(node: ast.Call) -> Iterator[Change]:
    for place, keyword in enumerate(node.keywords):
        if keyword.arg in SETTINGS or (keyword.arg and node.keywords and isinstance(node.func, ast.Attribute)):
            yield Change(lambda copied, place=place: copied.keywords.pop(place))  # type: ignore[misc, attr-defined]
    for place, argument in enumerate(node.args):
        if isinstance(argument, ast.Name) and "qos" in argument.id.lower():
            yield Change(lambda copied, place=place: copied.args.__setitem__(place, ast.Constant(10)))  # type: ignore


def _left_out(node: ast.AST) -> Iterator[Change]:
    """Each statement of a block left out: a call, an assignment, a return, a wait."""
    body: list[ast.stmt] = node.body  # type: ignore[attr-defined]
    for place, statement in enumerate(body):
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Import | ast.ImportFrom):
            continue
        if isinstance(statement, ast.Expr) and any(f"{name}(" in ast.unparse(statement) for name in NOT_COUNTED):
            continue

        def leave_out(copied: ast.AST, place: int = place) -> None:
            statements = copied.body  # type: ignore[attr-defined]
            statements[place : place + 1] = [] if len(statements) > 1 else [ast.Pass()]

        yield Change(leave_out)


def _without_operator(node: ast.AST) -> None:
    """`not x` and `-x` become x: as `+x`, or for what is no number a bool of it."""
    assert isinstance(node, ast.UnaryOp)
    if isinstance(node.op, ast.USub):
        node.op = ast.UAdd()
    else:
        node.operand = ast.UnaryOp(ast.Not(), node.operand)


def _without_await(node: ast.AST) -> None:
    """`await x` becomes x, given a name: what is awaited goes on by itself, if it does."""
    node.__class__ = ast.NamedExpr  # type: ignore[assignment]
    node.target = ast.Name("_", ast.Store())  # type: ignore[attr-defined]


def _set_to_assignment(node: ast.AST) -> None:
    """`x += y` becomes `x = y`."""
    assert isinstance(node, ast.AugAssign)
    target, value = node.target, node.value
    node.__class__ = ast.Assign  # type: ignore[assignment]
    node.targets, node.value = [target], value  # type: ignore[attr-defined]
    node.type_comment = None  # type: ignore[attr-defined]
