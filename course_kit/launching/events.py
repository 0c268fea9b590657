"""What happens during a launch: processes start, write and exit, timers fire, the launch shuts down."""

from __future__ import annotations

import signal
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.launching.entities import Action, LaunchDescriptionEntity
    from course_kit.launching.event_actions import TimerAction

Matcher = Callable[[Any], bool]


class Event:
    """Something that happened."""

    name = "launch.Event"


@dataclass(eq=False, repr=False)
class IncludeLaunchDescription(Event):
    """A launch description is to be visited."""

    name = "launch.events.IncludeLaunchDescription"
    launch_description: LaunchDescriptionEntity


@dataclass(eq=False, repr=False, kw_only=True)
class Shutdown(Event):
    """The launch is to end."""

    name = "launch.events.Shutdown"
    reason: str = "reason not given"
    due_to_sigint: bool = False


@dataclass(eq=False, repr=False, kw_only=True)
class ExecutionComplete(Event):
    """An action has been executed."""

    name = "launch.events.ExecutionComplete"
    action: Action


@dataclass(eq=False, repr=False, kw_only=True)
class TimerEvent(Event):
    """The time of a TimerAction is over."""

    name = "launch.events.TimerEvent"
    timer_action: TimerAction


class RunningProcessEvent(Event):
    """Something about a process that runs or ran."""

    name = "launch.events.process.RunningProcessEvent"

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

    name = "launch.events.process.ProcessStarted"


class ProcessExited(RunningProcessEvent):
    """A process has ended; `returncode` is negative for a signal."""

    name = "launch.events.process.ProcessExited"

    def __init__(self, *, returncode: int, **details: Any) -> None:
        super().__init__(**details)
        self.returncode = returncode


class ProcessIO(RunningProcessEvent):
    """A process wrote `text`, bytes as they came."""

    name = "launch.events.process.ProcessIO"
    source = ""

    def __init__(self, *, text: bytes, **details: Any) -> None:
        super().__init__(**details)
        self.text = text

    @property
    def from_stdout(self) -> bool:
        """Whether it is what the program prints."""
        return self.source == "stdout"

    @property
    def from_stderr(self) -> bool:
        """Whether it is what the program complains of."""
        return self.source == "stderr"


class ProcessStdout(ProcessIO):
    """A process wrote to stdout."""

    name = "launch.events.process.ProcessStdout"
    source = "stdout"


class ProcessStderr(ProcessIO):
    """A process wrote to stderr."""

    name = "launch.events.process.ProcessStderr"
    source = "stderr"


@dataclass(eq=False, repr=False, kw_only=True)
class ProcessTargetedEvent(Event):
    """Something that certain processes are to do."""

    name = "launch.events.process.ProcessTargetedEvent"
    process_matcher: Matcher


class ShutdownProcess(ProcessTargetedEvent):
    """Processes are to end."""

    name = "launch.events.process.ShutdownProcess"


class SignalProcess(ProcessTargetedEvent):
    """Processes are to get a signal, given by its number or name."""

    name = "launch.events.process.SignalProcess"

    def __init__(self, *, signal_number: str | int, process_matcher: Matcher) -> None:
        super().__init__(process_matcher=process_matcher)
        by_name = isinstance(signal_number, str)
        self.signal = signal.Signals[str(signal_number)] if by_name else signal.Signals(int(signal_number))
        self.is_there_already = False  # the processes have it from elsewhere: only tell

    @property
    def signal_name(self) -> str:
        """The signal's name, such as SIGINT."""
        return self.signal.name


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
