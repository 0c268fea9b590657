"""The help of every command and verb of `ros2`: each argument has a line of it."""

from __future__ import annotations

from argparse import ArgumentParser, _SubParsersAction

import pytest

from course_kit.ros2.command import COMMANDS, parser_for


def parsers_below(parser: ArgumentParser) -> dict[str, ArgumentParser]:
    groups = [action for action in parser._actions if isinstance(action, _SubParsersAction)]
    return dict(groups[0].choices) if groups else {}


def parser_of(*words: str) -> ArgumentParser:
    parser = parser_for(words)
    for word in words:
        parser = parsers_below(parser)[word]
    return parser


@pytest.mark.parametrize("command", COMMANDS)
def test_each_argument_is_explained(command):
    verbs = [(command, verb) for verb in parsers_below(parser_of(command))]
    for parser in [parser_of(command), *(parser_of(*words) for words in verbs)]:
        assert parser.format_help().startswith(f"usage: {parser.prog} ")
        assert all(action.help for action in parser._actions if not isinstance(action, _SubParsersAction)), parser.prog
