"""The help of every command and verb of `ros2`: each argument has a line of it."""

from __future__ import annotations

from argparse import ArgumentParser, _SubParsersAction

import pytest

from course_kit.cli.ros2.command import COMMANDS, parser_for, run


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


@pytest.mark.parametrize(
    ("words", "refusal"),
    [
        (("topic", "hz", "--window", "0"), "-w: value must be a positive integer"),
        (("topic", "bw", "--window", "ten"), "-w: value must be a positive integer"),
        (("topic", "echo", "--timeout", "0"), "--timeout: invalid positive_float value: '0'"),
        (("topic", "echo", "--truncate-length=-1"), "-l: value must be non-negative integer"),
        (("topic", "pub", "--rate", "fast"), "--rate: invalid positive_float value: 'fast'"),
        (("topic", "pub", "--times=-1"), "--times: invalid nonnegative_int value: '-1'"),
        (("topic", "pub", "-w", "1.5"), "--wait-matching-subscriptions: invalid nonnegative_int value: '1.5'"),
        (("bag", "play", "--rate", "0", "."), "--rate: 0 is not in the valid range (> 0.0)"),
        (("bag", "play", "--delay=-1", "."), "--delay: Value -1 is less than zero."),
        (("bag", "play", "--clock", "often", "."), "--clock: often is not the valid type (float)"),
        (
            ("bag", "play", "--qos-profile-overrides-path", "/no/such", "."),
            "path: can't open '/no/such': [Errno 2] No such file or directory: '/no/such'",
        ),
    ],
)
def test_a_value_that_cannot_be_is_refused_in_the_real_command_s_words(words, refusal, capsys):
    with pytest.raises(SystemExit):
        run(words)
    assert capsys.readouterr().err.endswith(f"{refusal}\n")
