"""Differences between an answer and the solution: in ROS's words where the source shows them, else by lines."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Iterator, Mapping
from typing import Any

from course_kit.exercises.solutions import answered
from course_kit.exercises.solutions.ros_calls import Endpoint, RosCalls

ALIKE = 0.4  # below this share of same lines, a comparison line by line cannot be read
DOCUMENTED = ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
MOST = 4  # names that are listed of one kind


def of_classes(mine: str, theirs: str, values: Mapping[str, Any] | None = None) -> list[str]:
    """Sentences on two sources of a class, and lines of a comparison in a block; none if they are the same code."""
    if normalised(mine) == normalised(theirs):
        return []
    words = list(in_words(RosCalls(mine, values), RosCalls(theirs)))
    return words or of_texts(normalised(mine), normalised(theirs))


def of_functions(mine: str, theirs: str) -> list[str]:
    """The same for two sources of a function, which has nothing to do with ROS."""
    mine, theirs = normalised(mine), normalised(theirs)
    return [] if mine == theirs else of_texts(mine, theirs)


def of_files(mine: str, theirs: str) -> list[str]:
    """The same for two files; those that have a class of the same name are compared as classes."""
    names = [node.name for node in _tree(theirs).body if isinstance(node, ast.ClassDef)]
    own, others = (answered.class_source(names[0], [text]) if names else None for text in (mine, theirs))
    if own and others:
        return of_classes(own, others)
    return [] if mine.split() == theirs.split() else of_texts(mine, theirs)


def of_texts(mine: str, theirs: str) -> list[str]:
    """A comparison line by line, as a block; a sentence where too little is alike."""
    lines, others = mine.splitlines(), theirs.splitlines()
    if difflib.SequenceMatcher(None, lines, others).ratio() < ALIKE:
        return ["Yours goes another way, so no comparison line by line is shown."]
    compared = difflib.unified_diff(lines, others, "yours", "the solution", lineterm="", n=2)
    return ["\n".join(["```diff", *compared, "```"])]


def _tree(source: str) -> ast.Module:
    """The code of a file that is Python; nothing of another one."""
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError):
        return ast.Module([], [])


def normalised(source: str) -> str:
    """The code alone: without comments, docstrings and layout."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, DOCUMENTED) and ast.get_docstring(node) is not None:
            node.body = node.body[1:] or [ast.Pass()]
    return ast.unparse(tree)


def in_words(mine: RosCalls, theirs: RosCalls) -> Iterator[str]:
    """What differs in nodes, endpoints, timers and calls."""
    if mine.node_name and mine.node_name != theirs.node_name:
        yield f"Your node is called `{mine.node_name}`, the solution's `{theirs.node_name}`."
    untold = {one.kind for one in (*mine.endpoints, *theirs.endpoints) if not one.name}
    yield from _endpoints(*([one for one in each.endpoints if one.kind not in untold] for each in (mine, theirs)))
    if mine.periods and theirs.periods and mine.periods != theirs.periods:
        own, other = (
            " and ".join(f"{period:g}" for period in sorted(periods)) for periods in (mine.periods, theirs.periods)
        )
        yield f"Your timer has a period of {own} s, the solution's of {other} s."
    if mine.is_async != theirs.is_async:
        has, other = ("The solution", "yours") if theirs.is_async else ("Yours", "the solution")
        yield f"{has} has coroutines (`async def`), {other} has none."
    if lacking := _listed(theirs.uses - mine.uses, theirs.options - mine.options):
        yield f"Yours has no {lacking}."
    if more := _listed(mine.uses - theirs.uses, mine.options - theirs.options):
        yield f"Only yours has {more}."


def _listed(uses: set[str], options: set[str]) -> str:
    return ", ".join(f"`{name}`" for name in [*sorted(uses), *sorted(options)][:MOST])


def _endpoints(mine: list[Endpoint], theirs: list[Endpoint]) -> Iterator[str]:
    left = list(mine)
    for other in theirs:
        kin = [one for one in left if one.kind == other.kind]
        same = [one for one in kin if one.name == other.name] or (kin if len(kin) == 1 else [])
        if not same:
            yield f"Yours has no {other.kind} for `{other.name}`."
            continue
        own = same[0]
        left.remove(own)
        if own.name != other.name:
            yield f"Your {own.kind} is for `{own.name}`, the solution's for `{other.name}`."
        yours = f"Your {own.kind} for `{own.name}`"
        if own.type != other.type:
            yield f"{yours} has the type `{own.type}`, the solution's `{other.type}`."
        for policy, wanted in zip(own.qos, other.qos, strict=False):
            if policy != wanted:
                yield f"{yours} is {policy}, the solution's {wanted}."
        if own.group and other.group and own.group != other.group:
            yield f"{yours} is in {own.group}, the solution's in {other.group}."
    for own in left:
        yield f"Only yours has a {own.kind} for `{own.name}`."
