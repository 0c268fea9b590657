"""Recordings of the real `ros2` command, reproduced: whole outputs, with a named rule for each part that varies."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.domains import own_domain
from tests.ros2_command import program, ros2

pytestmark = pytest.mark.by_turns("a program or a cell for each", of="cases")

FOLDER = Path(__file__).with_name("ros2_transcripts")
INTERRUPTED_STATUS = 124  # what `timeout` says in the recordings, whatever the command's own status was


@dataclass(frozen=True)
class Rule:
    """A part that differs from run to run: what it looks like, and what stands for it in the comparison."""

    name: str
    commands: str  # a regular expression for the command lines that it holds for
    pattern: str
    stands_for: str


RULES = (
    Rule("the talker counts on", r"topic echo /chatter", r"Hello ROS2: \d+", "Hello ROS2: N"),
    Rule("measured bandwidth", r"topic bw", r"^\d+ B/s from \d+ messages", "N B/s from N messages"),
    Rule("messages grow with the talker's count", r"topic bw", r"\b2[2-7] B", "SIZE"),
    Rule("the talker was seen at once or a little later", r"topic bw", r"^WARNING: topic .*\n", ""),
    Rule("how many lines fit before the interrupt", r"topic bw", r"(N B/s.*\n\t.*\n)+", "MEASURED\n"),
    Rule("the service was seen at once or a little later", r"service call", r"^waiting for service .*\n", ""),
    Rule("the subscription was seen at once or a little later", r"topic pub", r"^Waiting for at least .*\n", ""),
    Rule("parameters of a node that was set to 7 by a recording", r"param get \S+ beams", r"is: [57]$", "is: 5"),
)


@pytest.fixture(scope="module", autouse=True)
def world() -> Iterator[None]:
    with own_domain(), program("tests.ros2_transcripts.world"):
        yield


@dataclass(frozen=True)
class Transcript:
    words: list[str]
    interrupt_after: float | None
    out: str
    err: str
    status: int


def read(path: Path) -> Transcript:
    first, *rest = path.read_text().splitlines(keepends=True)
    interrupt_after = None
    if found := re.match(r"# interrupted \(SIGINT\) after (\d+) s", rest[0]):
        interrupt_after = float(found.group(1))
        rest = rest[1:]
    status = int(rest.pop().rsplit(" ", 1)[1])
    marker = rest.index("# stderr:\n") if "# stderr:\n" in rest else len(rest)
    words = shlex.split(first.removeprefix("$ ros2 "))
    return Transcript(words, interrupt_after, "".join(rest[:marker]), "".join(rest[marker + 1 :]), status)


def in_general(text: str, command: str) -> str:
    for rule in RULES:
        if re.search(rule.commands, command):
            text = re.sub(rule.pattern, rule.stands_for, text, flags=re.MULTILINE)
    return text


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.txt")), ids=lambda path: path.stem)
def test_the_command_prints_what_the_real_one_does(path):
    recorded = read(path)
    command = shlex.join(recorded.words)
    ours = ros2(*recorded.words, interrupt_after=recorded.interrupt_after)
    assert in_general(ours.out, command) == in_general(recorded.out, command)
    assert in_general(suggestions_apart(ours.err), command) == in_general(recorded.err, command)
    if recorded.status != INTERRUPTED_STATUS:
        assert ours.status == recorded.status


def suggestions_apart(err: str) -> str:
    """Without our suggestions, which the real command does not have."""
    return "".join(line for line in err.splitlines(keepends=True) if not line.startswith("Did you mean "))
