"""The events of a launch: processes start, write and exit, timers fire, the launch shuts down."""

from __future__ import annotations

import signal
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.cli.launching.entities import Action, LaunchDescriptionEntity
    from course_kit.cli.launching.event_actions import TimerAction

Matcher = Callable[[Any], bool]


class Event:
    """Something that happened; `name` is the real name of its type."""

    name = "launch.Event"

    def __init_subclass__(cls) -> None:
        if cls.__module__ == __name__:  # a launch file's own type names itself
            cls.name = f"launch.events.{'process.' * ('Process' in cls.__name__)}{cls.__name__}"


@dataclass(eq=False, repr=False)
class IncludeLaunchDescription(Event):
    """A launch description is to be visited."""

    launch_description: LaunchDescriptionEntity


@dataclass(eq=False, repr=False, kw_only=True)
class Shutdown(Event):
    """The launch is to end."""

    reason: str = "no reason is known"
    due_to_sigint: bool = False


@dataclass(eq=False, repr=False, kw_only=True)
class ExecutionComplete(Event):
    """An action has been executed."""

    action: Action


@dataclass(eq=False, repr=False, kw_only=True)
class TimerEvent(Event):
    """The time of a TimerAction is over."""

    timer_action: TimerAction


class RunningProcessEvent(Event):
    """Something about a process that runs or ran."""

    def __init__(
        self, *, action: Any, name: str, cmd: list[str], cwd: str | None, env: dict[str, str] | None, pid: int
    ) -> None:
        self.action = action
        self.process_name = name
        self.cmd = cmd
        self.cwd = cwd
        self.env = env
        self.pid = pid


class ProcessStarted(RunningProcessEvent):
    """A process has started."""


class ProcessExited(RunningProcessEvent):
    """A process has ended; `returncode` is negative for a signal."""

    def __init__(self, *, returncode: int, **details: Any) -> None:
        super().__init__(**details)
        self.returncode = returncode


class ProcessIO(RunningProcessEvent):
    """A process wrote `text`, bytes as they came."""

    source = ""

    def __init__(self, *, text: bytes, **details: Any) -> None:
        super().__init__(**details)
        self.text = text
        self.from_stdout = self.source == "stdout"
        self.from_stderr = self.source == "stderr"


class ProcessStdout(ProcessIO):
    """A process wrote to stdout."""

    source = "stdout"


class ProcessStderr(ProcessIO):
    """A process wrote to stderr."""

    source = "stderr"


@dataclass(eq=False, repr=False, kw_only=True)
class ProcessTargetedEvent(Event):
    """Something that certain processes are to do."""

    process_matcher: Matcher


class ShutdownProcess(ProcessTargetedEvent):
    """Processes are to end."""


class SignalProcess(ProcessTargetedEvent):
    """Processes are to get a signal, given by its number or name."""

    def __init__(self, *, signal_number: str | int, process_matcher: Matcher) -> None:
        super().__init__(process_matcher=process_matcher)
        signals = signal.Signals
        self.signal = signals[signal_number] if isinstance(signal_number, str) else signals(signal_number)
        self.signal_name = self.signal.name
        self.is_there_already = False  # the processes have it from elsewhere: only tell


def matches_action(target: Any) -> Matcher:
    """A matcher for the process of one action."""
    return lambda action: action is target


def matches_pid(pid: int) -> Matcher:
    """A matcher for the process of that id."""
    return lambda action: bool(action.process_details and action.process_details["pid"] == pid)


def matches_name(name: str) -> Matcher:
    """A matcher for the process of that name."""
    return lambda action: bool(action.process_details and action.process_details["name"] == name)


def matches_executable(executable: str) -> Matcher:
    """A matcher for processes whose command starts with that."""
    return lambda action: bool(action.process_details and action.process_details["cmd"][0] == executable)
