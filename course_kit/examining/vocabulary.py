"""What every check is written in: the answer on the stage, its node, its attributes, plain values.

Each expect_… notes one finding and returns whether it holds. Without `points` it must hold for the check to go on.
"""

from __future__ import annotations

import difflib
import time
from collections.abc import Callable
from typing import Any

from course_kit.examining.examination import now
from course_kit.spinning.nodes import WITHOUT_DESCRIPTIONS
from course_kit.turtlesim.node import TurtleSim
from course_kit.turtlesim.turtle import TICK

NODE_TIMEOUT = 3.0
SETTLE_TIMEOUT = 0.7  # seconds given to what may come a little later than the node
PROGRAM_SETTLE_TIMEOUT = 5.0  # the same in a program, whose constructor goes on when its node is in the graph


def answer(node_class: str, *arguments: Any, threads: bool = False) -> None:
    """Make a node of the student's class on the stage, as `run(node_class, …)` would; ends with the check.

    `threads`: with a MultiThreadedExecutor.
    """
    reply = now().order("start", 5.0, node_class=node_class, arguments=list(arguments), threads=threads)
    error = reply.get("error", "")
    hint = reply.get("trace", error)
    if "did not return" in error:
        hint = (
            f"The constructor of {node_class} did not return: a node that waits or loops there is never spun. "
            f"Wait in a callback, or with a done callback."
        )
    now().settle(f"a node is made of the class `{node_class}`", not error, hint)


def expect_node(name: str) -> None:
    """The answer's node has this full name."""
    station = now().stage
    now().wait(lambda: name in station.their_nodes(), NODE_TIMEOUT if not station.their_nodes() else SETTLE_TIMEOUT)
    station.known(NODE_TIMEOUT)  # its topics and services come a little later than its name
    there = station.their_nodes()
    short = name.rsplit("/", 1)[1]
    hint = (
        f'Your node is called {", ".join(there)}: the name is what you give to super().__init__("{short}").'
        if there
        else "No node of yours is in the graph: does its constructor call super().__init__()?"
    )
    now().settle(f"its node is called `{name}`", name in there, hint)


def settle_timeout() -> float:
    """Seconds given to what may come later than the answer's node."""
    return PROGRAM_SETTLE_TIMEOUT if now().exercise.file else SETTLE_TIMEOUT


def a_turtle(period: float = TICK) -> TurtleSim:
    """A turtlesim on the stage, as `run(TurtleSim)` would start it. `period`: seconds from tick to tick."""
    station = now().stage
    options = {"context": station.context, "enable_rosout": False, "parameter_overrides": WITHOUT_DESCRIPTIONS}
    made = station.spin(lambda: TurtleSim(period=period, **options))
    assert isinstance(made, TurtleSim)
    return made


def pause(seconds: float) -> None:
    """Let time pass in which nothing is done."""
    now().wait(lambda: False, seconds)


def wait(condition: Callable[[], Any], timeout: float, what: str = "", poll: float = 0.005) -> bool:
    """Wait until a condition holds; whether it did."""
    return now().wait(condition, timeout, what, poll)


def expect(text: str, ok: Any, hint: str, points: int = 0, needed: bool = False) -> bool:
    """Whatever the other words do not say: `ok` is true."""
    return now().settle(text, ok, hint, points, needed)


def call(method: str, *arguments: Any, timeout: float) -> tuple[Any, float]:
    """Call a method of the answer's node as a cell would; what it returned and the seconds that it took.

    A method that raises or does not return ends the check.
    """
    began = time.monotonic()
    reply = now().order("call", timeout, method=method, arguments=list(arguments))
    seconds = time.monotonic() - began
    if error := reply.get("error", ""):
        written = f"{method}({', '.join(map(repr, arguments))})"
        late = "did not return" in error
        hint = (
            f"`{written}` did not return within {timeout:g} s: it waits for what never comes. Give every wait a "
            "timeout."
            if late
            else f"`{written}` raised {reply.get('trace', error)}"
        )
        now().settle(f"`{written}` returns", False, hint)
    return reply.get("value"), seconds


def read(attribute: str) -> Any:
    """What an attribute of the answer's node holds; ends the check if there is none."""
    reply = now().order("read", attribute=attribute)
    if error := reply.get("error", ""):
        hint = f"Your node has no readable `self.{attribute}` ({error}). Set it in __init__."
        now().settle(f"the node has `self.{attribute}`", False, hint)
    return reply.get("value")


def wait_for_attribute(attribute: str, condition: Callable[[Any], Any], timeout: float) -> Any:
    """Read an attribute until it fits a condition or the time is over; its last value."""
    seen: list[Any] = []

    def fits() -> Any:
        seen[:] = [read(attribute)]
        return condition(*seen)

    wait(fits, timeout, poll=0.05)
    return seen[0]


def pending_calls() -> int:
    """How many futures still wait in the clients of the answer's node."""
    return int(now().order("pending").get("value") or 0)


def wait_for_servers(timeout: float) -> bool:
    """Wait until each client of the answer's node has found a server; whether it did."""
    return now().wait(lambda: now().order("ready").get("value"), timeout, "the node to find its servers", 0.05)


def expect_value(text: str, given: Any, wanted: Any, hint: str, points: int) -> bool:
    """A value that was handed to check() is the right one; what was given is quoted in front of the hint."""
    return now().settle(text, given == wanted, f"You gave {given!r}. {hint}", points)


def nearest(wanted: str, there: list[str]) -> str:
    """The name that may have been meant, as the beginning of a hint."""
    near = difflib.get_close_matches(wanted, there, n=1, cutoff=0.5)
    return f"Did you mean `{near[0]}`? " if near else ""
