"""What a verb of the `ros2` command is made of, and how it fails."""

from __future__ import annotations

import difflib
from argparse import SUPPRESS, ArgumentParser, Namespace, _ActionsContainer
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.kernel import in_kernel

if TYPE_CHECKING:
    from course_kit.ros2.session import Session


def _no_arguments(parser: ArgumentParser) -> None:
    pass


@dataclass(frozen=True)
class Verb:
    """One verb: its line in the help, what does it, its arguments.

    `run` returns the exit status, None for 0. It writes through the session and raises CommandError if it fails.
    """

    summary: str
    run: Callable[[Namespace, Session], int | None]
    arguments: Callable[[ArgumentParser], None] = _no_arguments


class CommandError(Exception):
    """A verb failed: one line for stderr as the real command has it, then a suggestion if there is one."""

    def __init__(self, message: str, suggestion: str | None = None, status: int = 1) -> None:
        super().__init__(message)
        self.suggestion = suggestion
        self.status = status


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """A line that suggests the known name nearest to `name`, or None if none is near."""
    candidates = sorted(set(known) - {name})
    last = name.rstrip("/").rsplit("/", 1)[-1]
    same_end = [c for c in candidates if last and c.rsplit("/", 1)[-1] == last]
    near = same_end or difflib.get_close_matches(name, candidates, n=1)
    return f"Did you mean {near[0]}?" if near else None


def add_flag(parser: _ActionsContainer, names: str, help: str) -> None:
    """An option without a value; `names` are separated by spaces."""
    parser.add_argument(*names.split(), action="store_true", help=help)


def add_offered(parser: ArgumentParser, name: str, offer: Callable[..., list[str]], help: str, **options: Any) -> None:
    """An argument for which Tab offers what a completer knows."""
    argument = parser.add_argument(name, help=help, **options)
    argument.completer = offer  # type: ignore[attr-defined]


def add_strategy_arguments(parser: ArgumentParser) -> None:
    """The options of verbs that read the graph."""
    add_node_arguments(parser)
    add_flag(parser, "--no-daemon", "Do not spawn nor use an already running daemon (there is none here)")


def add_node_arguments(parser: ArgumentParser) -> None:
    """The options of verbs that have a node of their own."""
    parser.add_argument(
        "--spin-time",
        type=float,
        default=None,
        help="Spin time in seconds to wait for discovery (by default until the graph is known)",
    )
    add_flag(parser, "-s --use-sim-time", "Enable ROS simulation time")


def add_duration_argument(parser: ArgumentParser) -> None:
    """The course's own option of verbs that go on until they are interrupted; a terminal's usage does not name it."""
    shown = "End after S seconds" if in_kernel() else SUPPRESS
    parser.add_argument("--duration", type=float, default=None, metavar="S", help=shown)
