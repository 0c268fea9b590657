"""Words in saved outputs that no cell can have made: another program was in the domain when the chapter was saved.

As a plugin of pytest beside nbval, which runs a chapter in a network of its own: what a cell with `ros2 node list` and
the like has saved must be there then, too.
"""

from __future__ import annotations

import re
from collections.abc import Generator, Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from nbformat import NotebookNode

COURSE_KIT = Path(__file__).parents[1] / "course_kit"
# Folders of course_kit with nodes that chapters start.
OWN_PROGRAMS = ("robots", "exercises/faults", "lab/scene", "lab/bags", "lab/tf_tools")
DRAWN = re.compile(r"(?<=static_transform_publisher)_\w{16}$")  # by which tf2's program tells itself from others
OF_EVERY_NODE = (
    "rosout parameter_events describe_parameters get_parameters get_parameter_types get_type_description "
    "list_parameters set_parameters set_parameters_atomically _action send_goal cancel_goal get_result feedback status "
    "_service_event clock tf tf_static launch ros2cli"
)
NO_NAME = re.compile(r"/(?:home|opt|usr|dev|tmp|bin|etc|proc|lib|var|sys|project|run)\b")  # begins a path of files
NAME = re.compile(r"(?<![\w/.~:*)\]}-])/[a-zA-Z_]\w*(?:/\w+)*(?![\w.]*\.(?:py|yaml|so|xml|html))")
LOGGED = re.compile(r"\[(?P<level>[A-Z]+)\] \[\d+\.\d+\] \[(?P<node>[\w./-]+)\]: (?P<text>.*)")
LIST = re.compile(r"^[%!]+ros2 (?:node|topic|service|action) list\b", re.MULTILINE)
WORD = re.compile(r"[^\W\d_]+\d*")


def shown(cell: NotebookNode) -> Iterator[str]:
    """The text of each saved output of a cell."""
    for output in cell.get("outputs", []):
        data = output.get("data", {})
        yield output.get("text") or data.get("text/plain") or ""


def words(text: str) -> set[str]:
    """All in it that is of letters, also the parts of names such as `fibonacci_client`."""
    return set(WORD.findall(text))


@cache
def known_words() -> frozenset[str]:
    """Those that course_kit's own programs and every node may say."""
    files = [file for room in OWN_PROGRAMS for file in (COURSE_KIT / room).rglob("*.py")]
    return frozenset(words(OF_EVERY_NODE).union(*(words(file.read_text()) for file in files)))


def made_by(cells: Iterable[NotebookNode]) -> frozenset[str]:
    """The words that programs of these cells can say: those of their code, and of the course's own programs."""
    return known_words().union(*(words(cell.source) for cell in cells if cell.cell_type == "code"))


def foreign_names(text: str, made: frozenset[str]) -> list[str]:
    """Names of nodes, topics and services in an output, and loggers, of which no cell has the words."""
    whole = (match for match in NAME.finditer(text) if text[match.end() : match.end() + 1] != "…")
    names = [match[0] for match in whole if not NO_NAME.match(match[0])]
    names += [DRAWN.sub("", match["node"]) for match in LOGGED.finditer(text)]
    return sorted({name for name in names if not words(name) <= made})


def foreign_lines(text: str, made: frozenset[str]) -> list[str]:
    """What nodes have logged for information with words that no cell has; warnings may be those of ROS."""
    lines = [match for match in LOGGED.finditer(text) if match["level"] == "INFO"]
    return [line["text"] for line in lines if not words(line["text"]) <= made]


def listed(texts: Iterable[str]) -> set[str]:
    """The names that a list of nodes, topics, services or actions tells, without those that differ by chance."""
    lines = {line.split()[0] for text in texts for line in text.splitlines() if line.startswith("/")}
    return {line for line in lines if not re.search(r"/_|\d{3,}", line)}


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: Any) -> Generator[None, Any, Any]:
    """After a cell of a notebook: AssertionError if its saved list tells what is not there now."""
    result = yield
    cell = getattr(item, "cell", None)
    if cell is not None and LIST.search(cell.source):
        gone = listed(shown(cell)) - listed(shown(NotebookNode(outputs=item.test_outputs)))
        assert not gone, f"{cell.id} has saved {', '.join(sorted(gone))}: of another program in the domain?"
    return result
