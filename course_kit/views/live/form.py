"""A form under a cell for any topic, service or action: fill in the fields, send, and see what comes back."""

from __future__ import annotations

import copy
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import traitlets
from anywidget import AnyWidget

from course_kit.base.arguments import WAIT, takes
from course_kit.views.forms.calling import GoalSender
from course_kit.views.forms.command_line import command_line
from course_kit.views.forms.fields import read
from course_kit.views.forms.interface import Interface
from course_kit.views.forms.lookup import find
from course_kit.views.forms.program import program
from course_kit.views.forms.sending import Publishing, sender
from course_kit.views.live.shown import Bundle
from course_kit.views.live.view import View, as_text

PERIOD = 0.1  # seconds between two looks at how sending goes: feedback may come a thousand times a second
FASTEST = 1000.0  # Hz
ENDINGS = ("stop", "cancel")  # what is done whatever is typed in


class FormWidget(AnyWidget):
    """The form in the page."""

    # As texts: of files, anywidget keeps every widget for ever, to tell it when they change.
    _esm = traitlets.Unicode(Path(__file__).with_suffix(".js").read_text("utf-8")).tag(sync=True)
    _css = traitlets.Unicode(Path(__file__).with_suffix(".css").read_text("utf-8")).tag(sync=True)
    interface = traitlets.Dict().tag(sync=True)
    entries = traitlets.Dict().tag(sync=True)  # with the page that has written them, which knows them
    problems = traitlets.Dict().tag(sync=True)  # one sentence by path
    command = traitlets.Unicode().tag(sync=True)
    program = traitlets.Unicode().tag(sync=True)
    state = traitlets.Dict().tag(sync=True)


class Form(View):
    """A form of an interface, until stop() or the next run of its cell."""

    kind = "form"

    def __init__(self, interface: Interface) -> None:
        self.interface = interface
        self.entries: Any = copy.deepcopy(interface.root.default)
        self._rate, self._is_repeated = "1", False
        self._sender = sender(interface)
        about = {"noun": interface.noun, "name": interface.name, "type": interface.type_name}
        self.widget = FormWidget(interface={**about, "root": interface.root.as_data()})
        self.widget.on_msg(self._on_message)
        self._read("")
        self._open(PERIOD, math.inf, self.widget)

    def still(self) -> Bundle:
        """The command, how sending goes, the last answer."""
        state = self._sender.state
        parts = [self.widget.command, state.line, state.answer]
        return as_text("\n".join(part for part in parts if part))

    def _show(self) -> float:
        self._say_state()
        self._keep()
        return PERIOD

    def _say_state(self) -> None:
        state = asdict(self._sender.state)
        if state != self.widget.state:
            self.widget.state = state

    def _on_message(self, _: Any, said: dict[str, Any], __: Any) -> None:
        """What is typed into a page, and which button is pressed there."""
        what = said["do"]
        self.entries, self._rate = said["entries"], str(said["rate"])
        if what != "read":
            self._is_repeated = what == "start"  # so that command and program do the same
        value = self._read(said["by"])
        try:
            if what in ENDINGS or value is not None:
                self._do(what, value)
        except Exception as error:  # there is no other place where it could be seen
            self._sender.fail(error)
        self._say_state()

    def _read(self, by: str) -> Any:
        """The value of the entries, None if there are problems; both are shown, and the same as text."""
        value, problems = read(self.interface.root, self.entries)
        texts = ["\n".join(f"# {problem}" for problem in problems.values())] * 2
        fits, rate = not problems, _rate(self._rate)
        if fits:
            shown = rate if self._is_repeated else None
            texts = [command_line(self.interface, value, shown), program(self.interface, value, shown)]
        if rate is None:
            problems["rate"] = f"The rate is a number above 0, at most {FASTEST:g}, such as 0.5 or 10."
        with self.widget.hold_sync():
            self.widget.entries = {"values": self.entries, "rate": self._rate, "by": by}
            self.widget.command, self.widget.program = texts
            self.widget.problems = problems
        return value if fits else None

    def _do(self, what: str, value: Any) -> None:
        sends = self._sender
        if isinstance(sends, Publishing):
            if what == "start" and (rate := _rate(self._rate)) is not None:
                sends.start(value, rate)
            elif what == "stop":
                sends.stop()
            elif what == "send":
                sends.send(value)
            elif what == "read":
                sends.update(value)
        elif what == "send":
            sends.send(value)
        elif what == "cancel" and isinstance(sends, GoalSender):
            sends.cancel()

    def _end(self, error: Exception | None) -> None:
        self._sender.close()  # first: the last still says how it ended
        super()._end(error)


def _rate(text: str) -> float | None:
    try:
        rate = float(text)
    except ValueError:
        return None
    return rate if 0 < rate <= FASTEST else None


@takes(timeout=WAIT)
def show_form(name: str, interface: Any = None, timeout: float = 5.0) -> Form:
    """Show a form for a topic, a service or an action: fill in the fields, publish, call or send a goal.

    Without `interface`, a class or a name such as 'geometry_msgs/msg/Twist', the type is looked up in the graph for
    up to `timeout` seconds. It ends with .stop() or the next run of its cell. Stands for rqt_publisher and
    rqt_service_caller, and shows the same as a `ros2` command and in Python.
    """
    return Form(find(name, interface, timeout))
