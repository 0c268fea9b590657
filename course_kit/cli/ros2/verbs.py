"""The parts of a verb of the `ros2` command: arguments, converters, failures."""

from __future__ import annotations

import contextlib
import difflib
import os
import re
import stat
import warnings
from argparse import SUPPRESS, Action, ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from course_kit.base.kernel import in_kernel
from course_kit.ros import packages

if TYPE_CHECKING:
    from course_kit.cli.ros2.session import Session

Arguments = Callable[[Any], object]  # adds arguments to a parser, or to a group of one
Found = TypeVar("Found")
Number = TypeVar("Number", int, float)

BACKGROUND = "--background"
LARGEST = 2**63 - 1  # what an integer of ROS holds
LONGEST = 9e9  # seconds: a time of ROS counts nanoseconds in such an integer
LONGEST_TEXT = 2000  # characters of a message, which repeats what was typed


class Verb:
    """One verb: its line in the help, what does it, its arguments.

    `run` returns the exit status, None for 0. It writes through the session and raises CommandError if it fails.
    """

    def __init__(self, summary: str, run: Callable[[Namespace, Session], int | None], *arguments: Arguments) -> None:
        self.summary, self.run, self.arguments = summary, run, all_of(*arguments)


class CommandError(Exception):
    """A verb failed: one line for stderr as the real command has it, then a suggestion if there is one."""

    def __init__(self, message: str, suggestion: str | None = None, status: int = 1) -> None:
        super().__init__(message)
        self.suggestion = suggestion
        self.status = status


@contextlib.contextmanager
def failing(*kinds: type[BaseException], say: Callable[[Any], str] = str) -> Iterator[None]:
    """Exceptions of these kinds in the block are failures of the verb; `say` makes the line of them."""
    try:
        yield
    except kinds as error:
        if was_interrupt(error):
            raise KeyboardInterrupt from None
        raise CommandError(say(error)) from None


def was_interrupt(error: BaseException) -> bool:
    """Return True if an interrupt became this error: rclpy makes another of it while it converts a message."""
    return isinstance(error.__cause__, KeyboardInterrupt)


def one_line(error: Exception) -> str:
    """What an exception says, in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def cut(text: str) -> str:
    """A message, without the middle of it if it is very long."""
    if len(text) <= LONGEST_TEXT:
        return text
    half = LONGEST_TEXT // 2
    return f"{text[:half]} [... {len(text) - 2 * half} characters ...] {text[-half:]}"


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """A line that suggests the known name nearest to `name`, or None if none is near."""
    candidates = sorted(set(known) - {name})
    last = name.rstrip("/").rsplit("/", 1)[-1]
    same_end = [c for c in candidates if last and c.rsplit("/", 1)[-1] == last]
    same_end.sort(key=lambda c: difflib.SequenceMatcher(None, c, name).ratio(), reverse=True)
    near = same_end or difflib.get_close_matches(name, candidates, n=1)
    return f"Did you mean {near[0]}?" if near else None


def look_up(look: Callable[[str], Found], name: str, message: str = "Package '{}' not found") -> Found:
    """What a look-up of a package gives; a failure of the verb if there is no such package."""
    try:
        return look(name)
    except LookupError as reason:
        raise CommandError(message.format(name, reason), did_you_mean(name, packages.package_names())) from None


def compiled(pattern: str, refusal: str = "'{}' is no regular expression: {}") -> re.Pattern[str]:
    """A regular expression; a failure of the verb if the text is none."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of what a later Python may read otherwise
            return re.compile(pattern)
    except (re.error, OverflowError, RecursionError) as error:
        raise CommandError(refusal.format(pattern, error)) from None


def refuse_device(path: str) -> None:
    """A failure of the verb for a device such as /dev/zero, which may be read without end; a pipe is none."""
    with contextlib.suppress(OSError):
        mode = os.stat(path).st_mode
        if stat.S_ISCHR(mode) or stat.S_ISBLK(mode):
            raise CommandError(f"'{path}' is a device: give a file")


def argument(names: str, help: str, offer: Callable[..., list[str]] | None = None, **settings: Any) -> Arguments:
    """An argument or an option, its names separated by spaces; Tab offers for it what a completer knows.

    A help that speaks of N has N for the value.
    """
    if re.search(r"\bN(?:th)?\b", help):
        settings = {"metavar": "N", **settings}

    def add(parser: Any) -> None:
        parser.add_argument(*names.split(), help=help, **settings).completer = offer

    return add


def flag(names: str, help: str) -> Arguments:
    """An option without a value."""
    return argument(names, help, action="store_true")


def all_of(*arguments: Arguments) -> Arguments:
    """Several arguments, in this order."""

    def add(parser: Any) -> None:
        for one in arguments:
            one(parser)

    return add


def one_of(*arguments: Arguments) -> Arguments:
    """Arguments of which a command line has one at most."""
    return lambda parser: all_of(*arguments)(parser.add_mutually_exclusive_group())


def number(
    kind: Callable[[str], Number], is_valid: Callable[[Number], bool], refusal: str, largest: float = LARGEST
) -> Callable[[str], Number]:
    """A type of argparse: a number that `is_valid`, finite and not above `largest`.

    `refusal` is what the real command says of another text; it takes infinity and nan, and what comes of them.
    """

    def convert(text: str) -> Number:
        hint = ""
        with contextlib.suppress(ValueError):
            value = kind(text)
            if not abs(value) <= largest:  # nan is neither
                hint = f" (finite, at most {largest:g})"
            elif is_valid(value):
                return value
        raise ArgumentTypeError(refusal.format(text) + hint)

    return convert


positive_float = number(float, lambda value: value > 0, "invalid positive_float value: {!r}", LONGEST)
seconds = number(float, lambda value: value >= 0, "invalid float value: {!r}: write seconds, 0 or more", LONGEST)
whole = number(int, lambda value: value >= 0, "invalid int value: {!r}: write a whole number, 0 or more")


def yaml_values(name: str, example: str, offer: Callable[..., list[str]]) -> Arguments:
    """What a message is filled in with."""
    about = f"fields to set, as YAML, such as '{example}'; a time may be now, a header auto"
    values = argument(name, about, offer, nargs="?", default="{}")
    return one_of(values, flag("--stdin", "read them from the standard input"))


def duration(parser: Any) -> None:
    """The course's own option of verbs that go on until they are interrupted; a terminal's usage does not name it."""
    shown = "end after S seconds" if in_kernel() else SUPPRESS
    parser.add_argument("--duration", type=seconds, default=None, metavar="S", help=shown)


class _Refused(Action):
    """An option for notebooks alone."""

    def __call__(self, parser: ArgumentParser, *_: object) -> NoReturn:
        parser.error(f"{BACKGROUND} is for %ros2 in a notebook: in a terminal write & after the command line")


def background(parser: Any) -> None:
    """The course's own option of all verbs in a notebook, see magic.py; a terminal's usage does not name it."""
    if in_kernel():
        parser.add_argument(BACKGROUND, action="store_true", help="go on in a view of its own; the cell is done")
    else:
        parser.add_argument(BACKGROUND, action=_Refused, nargs=0, help=SUPPRESS)


# The options of verbs that have a node of their own, and of those that read the graph.
NODE = all_of(
    argument("--spin-time", "look for other nodes for N seconds (default: until all are known)", type=seconds),
    flag("-s --use-sim-time", "use simulated time, from /clock"),
)
GRAPH = all_of(NODE, flag("--no-daemon", "ignored: there is no daemon here"))
