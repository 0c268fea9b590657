"""The base of the senders of a form: their state, and the parts that all kinds have in common."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from course_kit.cli.ros2.messages.values import populate, stamp
from course_kit.ros.subscriptions import observer_node
from course_kit.views.forms.interface import Interface


@dataclass(frozen=True)
class State:
    """How sending goes: one line, the last answer, whether it goes on, and whether the line tells of a failure."""

    line: str = ""
    answer: str = ""
    is_busy: bool = False
    is_problem: bool = False


class Sender:
    """Sends values of an interface, as `read()` gives them, without waiting; `state` says how that goes."""

    def __init__(self, interface: Interface) -> None:
        self.interface = interface
        self._state = State()

    @property
    def state(self) -> State:
        """How it goes."""
        return self._state

    def send(self, value: Any) -> None:
        """Begin to send a value."""
        raise NotImplementedError

    def close(self) -> None:
        """End what goes on."""
        raise NotImplementedError

    def fail(self, error: Exception) -> None:
        """Say what went wrong."""
        is_ours = isinstance(error, LookupError | TimeoutError)  # which is a sentence by itself
        said = error.args[0] if is_ours and error.args else f"{type(error).__name__}: {error}"
        self._state = replace(self._state, line=str(said), is_problem=True)

    def _filled(self, value: Any) -> tuple[Any, list[Any]]:
        """The message of a value, and the times in it that stand for the time of sending."""
        message = self.interface.message_type()
        return message, populate(message, value)

    def _stamped(self, value: Any) -> Any:
        message, times = self._filled(value)
        stamp(times, *observer_node.node().get_clock().now().seconds_nanoseconds())
        return message
