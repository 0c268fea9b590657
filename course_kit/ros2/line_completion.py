"""Completes a `ros2` command line: for the shell, which asks through argcomplete's variables, and for `%ros2`."""

from __future__ import annotations

import itertools
import os

from course_kit.ros2.command import parser_for


def complete(line: str) -> list[str]:
    """The words that may stand in place of the last, unfinished word of what follows `ros2`."""
    import argcomplete
    from argcomplete.lexers import split_line

    _, begun, _, words, _ = split_line(f"ros2 {line}")
    finder = argcomplete.CompletionFinder(parser_for(words[1:]))
    found = itertools.takewhile(bool, (finder.rl_complete(line, state) for state in itertools.count()))
    return [str(match)[len(line) - len(begun) :].rstrip() for match in found]


def answer_shell() -> None:
    """Complete the line that argcomplete's shell function hands over, then exit."""
    import argcomplete
    from argcomplete.lexers import split_line

    line = os.environ["COMP_LINE"].encode()[: int(os.environ["COMP_POINT"])].decode(errors="ignore")
    words = split_line(line)[3]
    argcomplete.autocomplete(parser_for(words[1:]))
