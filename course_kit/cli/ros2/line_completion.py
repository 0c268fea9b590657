"""Completes a `ros2` command line: for the shell, which asks through argcomplete's variables, and for `%ros2`."""

from __future__ import annotations

import itertools
import os
import re
import shlex

from argcomplete import CompletionFinder
from argcomplete.lexers import split_line

from course_kit.cli.ros2.command import end, parser_for

_YAML = re.compile(r"(?<=\s)\{[^'\\]*$")


class _Finder(CompletionFinder):
    """Offers the YAML of a message without the options beside it, and in quotes."""

    def filter_completions(self, completions: list[str]) -> list[str]:
        yaml = [text for text in completions if text.startswith("{")]
        return list(super().filter_completions(yaml or completions))

    def quote_completions(self, completions: list[str], prequote: str, last_break: int | None) -> list[str]:
        if not prequote and completions and completions[0].startswith("{"):
            if not _is_zsh():
                return [shlex.quote(text) for text in completions]
            prequote = "'"  # zsh itself puts backslashes before what needs them
        return list(super().quote_completions(completions, prequote, last_break))


class _UnquotedFinder(_Finder):
    def quote_completions(self, completions: list[str], prequote: str, last_break: int | None) -> list[str]:
        return completions


def complete(line: str) -> list[str]:
    """The words that may stand in place of the last, unfinished word of what follows `ros2`."""
    begun = split_line(f"ros2 {line}")[1]
    return [begun + rest for rest in endings(line)]


def endings(line: str) -> list[str]:
    """What may be appended to what follows `ros2`."""
    prequote, begun, _, words, _ = split_line(f"ros2 {line}")
    finder = _UnquotedFinder(parser_for(words[1:]))
    found = itertools.takewhile(bool, (finder.rl_complete(line, state) for state in itertools.count()))
    return [_quoted(str(match)[len(line) :], prequote, begun) for match in found]


def _quoted(rest: str, prequote: str, begun: str) -> str:
    """The rest of a word, as it continues what is typed of it."""
    if prequote == "'":
        return rest.replace("'", "'\\''")
    if prequote:
        return rest.replace("\\", "\\\\").replace('"', '\\"')
    return shlex.quote(rest) if rest and not begun else rest


def _is_zsh() -> bool:
    return os.environ.get("_ARGCOMPLETE_SHELL") == "zsh"


def answer_shell() -> None:
    """Complete the line that argcomplete's shell function hands over, then exit."""
    line = os.environ["COMP_LINE"].encode()[: int(os.environ["COMP_POINT"])].decode(errors="ignore")
    if _is_zsh() and (begun := _YAML.search(line)):  # it leaves out the quote that is open
        line = f"{line[: begun.start()]}'{begun[0]}"
    os.environ.update(COMP_LINE=line, COMP_POINT=str(len(line)))
    try:
        _Finder()(parser_for(split_line(line)[3][1:]), exit_method=end)
    finally:
        end(1)  # an answer that failed must leave the graph, too
