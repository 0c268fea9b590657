"""What explains, in the help of `ros2` and in what is said of a wrong launch file, is in the course's own words.

Of the real command's explanations only digests are here. What people and scripts read of an
output is the same as there.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

import pytest

import course_kit
from course_kit.cli.ros2.command import COMMANDS
from tests.test_ros2_help import parser_of, parsers_below

LAUNCHING = sorted((Path(course_kit.__file__).parent / "cli/launching").glob("*.py"))
THEIRS = re.findall(
    "[0-9a-f]{8}",
    """
    047b72b1 058e474a 0d77bf9f 0de8a8c0 15f1e9cc 1623e22c 169c7d96 223918f0 22d2fc5c 23dbf88f 257be573
    258cf533 29282b57 2a97a387 2d13ce90 3335b60a 3490abb6 36252057 36f950fe 3755b689 39f9c98e 3a1aae67
    3bd17dd9 3cd2251c 480dae3f 494f1b66 4d2360cf 4e9ed328 500c5c02 51221df3 54d7044f 5501abda 5663c5db
    598e4d57 59e340ac 5a61e2fa 5d34ac14 6025844e 605c2775 654a4ad9 696e7b55 6e8bf931 7136074c 72e4e4c8
    73e0cdd6 753b7104 75f47af7 7e170398 834db4d6 83d3b61d 86deff97 87da5b75 88bd97d6 89735812 8c6da179
    8f4eac37 8f922e27 90a5f9cd 90bb9a26 919be72e 9249259b 95129cd1 9814cfaf 9a4fc81a 9f0d097a a00ed2ce
    a16982c3 a3421f35 a3a25eef a46d98c6 a71cb970 a8e9784b a9bef436 affcf4c8 b0144d94 b09f7598 b7325cb0
    b8dff632 be4da2f1 bf1e8efe c0fb5511 c1321b66 c2e0aa31 c59af21a c80b7e35 cbad9a67 cc3fb0a6 ce56abaa
    d230cf50 d2c12730 d63ac93d d655fb49 d751a619 d8f5f119 dca97f6f dd0f8205 dddbe0ff de6a3aab dfc413c3
    dfe26b9a e105093a e1cd39ef e1d65690 e3f161a2 e663b261 e7cdbba1 e8343a19 e88ab4c4 e960e9ad e9643f08
    ec03b657 ed06e51c f356dd38 f561c117 f5b35a01 f5d981f5 f603e39a f626f7ef f91dd26a f9f6f681 fb2b28ba
    fc1c4e4a fe1ef93c fe53bc09
    """,
)


def digest(text: str) -> str:
    """The same for texts of the same words."""
    return sha256(" ".join(re.findall("[a-z]+", text.lower())).encode()).hexdigest()[:8]


def helps(command: str) -> Iterator[str]:
    """What the help of a command and its verbs says of them and their arguments."""
    below = parsers_below(parser_of(command))
    for parser in [parser_of(command), *(parser_of(command, verb) for verb in below)]:
        yield parser.description or ""
        yield from (str(action.help) for action in parser._actions)


def texts(path: Path) -> Iterator[str]:
    """The texts in a module, with nothing where values are filled in."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(part.value) if isinstance(part, ast.Constant) else " " for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_is_in_own_words(command):
    assert [text for text in helps(command) if digest(text) in THEIRS] == []


@pytest.mark.parametrize("path", LAUNCHING, ids=lambda path: path.stem)
def test_what_is_said_of_a_launch_file_is_in_own_words(path):
    assert [text for text in texts(path) if digest(text) in THEIRS] == []
