"""Assertions that every check needs: the answer in the test domain, its node, its attributes, plain values.

Each expect_… notes one finding and returns whether it holds. If it has no points, it must hold for the check to go on.
"""

from __future__ import annotations

import difflib
import secrets
import time
from collections.abc import Callable, Sequence
from random import Random
from typing import Any

from course_kit.base.arguments import shown
from course_kit.exercises.checker.examination import POLL, current
from course_kit.robots.turtlesim.node import TurtleSim
from course_kit.robots.turtlesim.turtle import TICK
from course_kit.ros.interface_types import type_name
from course_kit.ros.observing.domain_observer import MOST_PROCESSES, hidden_name
from course_kit.ros.spinning.nodes import WITHOUT_DESCRIPTIONS

NODE_TIMEOUT = 3.0
TEST_DOMAIN_TIMEOUT = 5.0
ARRIVAL_TIMEOUT = 0.7  # seconds given to what may come a little later than the node
PROGRAM_ARRIVAL_TIMEOUT = 5.0  # the same in a program, whose constructor goes on when its node is in the graph


def answer(threads: bool | None = False, use_sim_time: bool = False) -> None:
    """Make a node of the student's class in the test domain, as `run(…)` would, and look at its name.

    `threads`: with a MultiThreadedExecutor; None: if the student runs it with one, or an action of it blocks a thread.
    `use_sim_time`: its clock is that of a_robot(). From then on only what its participant does counts.
    """
    exercise, test_domain = current().exercise, current().test_domain
    before = test_domain.their_nodes()
    keeper = hidden_name(secrets.randbelow(MOST_PROCESSES))
    order = {"node_class": exercise.node_class, "threads": threads, "keeper": keeper, "use_sim_time": use_sim_time}
    reply = current().order("start", 5.0, **order)
    error = reply.get("error", "")
    hint = reply.get("trace", error)
    if "did not return" in error:
        hint = (
            f"The constructor of {exercise.node_class} did not return: a node that waits or loops there is never "
            f"spun. Wait in a callback, or with a done callback."
        )
    require(f"a node is made of the class `{exercise.node_class}`", not error, hint)
    is_seen = test_domain.examine(keeper, TEST_DOMAIN_TIMEOUT, current().pid)
    require("the checker sees where it runs", is_seen, "Its process was not found. Restart the kernel and try again.")
    if exercise.node:
        expect_node(exercise.node, before)


def expect_node(name: str, before: Sequence[str] = ()) -> None:
    """The answer's node has this full name; nodes of `before`, of an earlier check, may not have left the graph yet."""
    observer = current().test_domain

    def theirs() -> list[str]:
        return [node for node in observer.their_nodes() if node == name or node not in before]

    wait(lambda: name in theirs(), ARRIVAL_TIMEOUT if theirs() else NODE_TIMEOUT)
    observer.known(NODE_TIMEOUT)  # its topics and services come a little later than its name
    names = theirs() or observer.their_nodes()
    short = name.rsplit("/", 1)[1]
    hint = (
        f'Your node is called {", ".join(names)}: the name is what you give to super().__init__("{short}").'
        if names
        else "No node of yours is in the graph: does its constructor call super().__init__()?"
    )
    require(f"its node is called `{name}`", name in names, hint)


def arrival_timeout() -> float:
    """Seconds given to what may come later than the answer's node."""
    return PROGRAM_ARRIVAL_TIMEOUT if current().exercise.file else ARRIVAL_TIMEOUT


def a_turtle(period: float = TICK) -> TurtleSim:
    """A turtlesim in the test domain, as `run(TurtleSim)` would start it. `period`: seconds from tick to tick.

    It keeps up on a busy machine: else whoever drives by the clock would get less far than she should.
    """
    observer = current().test_domain
    options = {"context": observer.context, "enable_rosout": False, "parameter_overrides": WITHOUT_DESCRIPTIONS}
    turtlesim = TurtleSim(period=period, keeps_up=True, **options)
    observer.spin(turtlesim)
    return turtlesim


def place_turtle(turtlesim: TurtleSim, x: float, y: float, theta: float) -> None:
    """Put turtle1 of a_turtle() somewhere else (metres, radians), and wait until it is there."""
    turtle = turtlesim.world.turtles.get("turtle1")
    if turtle is None:
        require("turtle1 is there", False, "It was killed.")
        return
    turtlesim.world.teleport_absolute("turtle1", x, y, theta)
    wait(lambda: not turtle.teleports, 1.0, "the turtle to be put in its place")
    pause(2 * TICK)  # until its pose is published


def chance() -> Random:
    """Where a check draws orders, counts, values and moments from: another each time, the same for the same seed."""
    return current().random


def nobody_else(*topics: str) -> None:
    """From now on nobody but the answer and the checker may have an end of these topics, as DDS spells them."""
    current().only_for_the_answer.update(topics)


def time_left() -> float:
    """Seconds until the exercise's time is over."""
    return current().left


def pause(seconds: float) -> None:
    """Let time pass in which nothing is done."""
    wait(lambda: False, seconds)


def wait(condition: Callable[[], Any], timeout: float, what: str = "", poll: float = POLL) -> bool:
    """Wait until a condition holds; whether it did."""
    return current().wait(condition, timeout, what, poll)


def expect(text: str, ok: Any, hint: str, points: int = 1, needed: bool = False) -> bool:
    """Whatever the other words do not say: `ok` is true. If not, its points are lost; if `needed`, the check ends."""
    return current().judge(text, ok, hint, points, needed)


def require(text: str, ok: Any, hint: str) -> None:
    """The same of what has no points: it must hold for the check to go on."""
    current().judge(text, ok, hint)


def call(method: str, *arguments: Any, timeout: float, may_raise: bool = False) -> tuple[Any, float]:
    """Call a method of the answer's node as a cell would; return its value and the seconds that it took.

    A method that raises or does not return ends the check. Where it may raise, the value is None in both cases.
    """
    began = time.monotonic()
    reply = current().order("call", timeout, method=method, arguments=list(arguments))
    seconds = time.monotonic() - began
    if (error := reply.get("error", "")) and not may_raise:
        written = f"{method}({', '.join(map(repr, arguments))})"
        hint = f"`{written}` raised {reply.get('trace', error)}"
        if "did not return" in error:
            hint = f"`{written}` did not return within {timeout:g} s: it waits for what never comes. "
            hint += "Give every wait a timeout."
        require(f"`{written}` returns", False, hint)
    return reply.get("value"), seconds


def compute(*arguments: Any, timeout: float) -> Any:
    """Call the answer's function; what it returned, as JSON has it. Lists come to it as numpy arrays.

    One that raises or does not return ends the check.
    """
    function = current().exercise.function
    reply = current().order("compute", timeout, function=function, arguments=list(arguments))
    if error := reply.get("error", ""):
        written = f"{function}({', '.join(_short(one) for one in arguments)})"
        hint = f"It raised {reply.get('trace', error)}"
        if "did not return" in error:
            hint = f"It did not return within {timeout:g} s: does a loop in it end?"
        require(f"`{written}` returns", False, hint)
    return reply.get("value")


def _short(argument: Any) -> str:
    return f"array of {len(argument)}" if isinstance(argument, list) else f"{argument:.6g}"


def read(attribute: str) -> Any:
    """What an attribute of the answer's node holds; ends the check if there is none."""
    reply = current().order("read", attribute=attribute)
    if error := reply.get("error", ""):
        hint = f"Your node has no readable `self.{attribute}` ({error}). Set it in __init__."
        require(f"the node has `self.{attribute}`", False, hint)
    return reply.get("value")


def wait_for_attribute(attribute: str, condition: Callable[[Any], Any], timeout: float, needed: bool = True) -> Any:
    """Read an attribute until it fits a condition or the time is over; its last value.

    It may appear late, as some do with a result. If there is none in all that time, the check ends if it is `needed`,
    and else it is None.
    """
    reply: dict[str, Any] = {}

    def fits() -> Any:
        nonlocal reply
        reply = current().order("read", attribute=attribute)
        return "error" not in reply and condition(reply.get("value"))

    wait(fits, timeout, poll=0.05)
    return read(attribute) if needed and "error" in reply else reply.get("value")


def raised() -> list[str]:
    """What callbacks of the answer's node have raised, and where: a program would have ended there."""
    return list(current().order("errors").get("value") or [])


def pending_calls() -> int:
    """How many futures still wait in the clients of the answer's node."""
    return int(current().order("pending").get("value") or 0)


def wait_for_servers(timeout: float) -> bool:
    """Wait until each client of the answer's node has found a server; whether it did."""
    return wait(lambda: current().order("ready").get("value"), timeout, "the node to find its servers", 0.05)


def wait_for_servers_to_leave(timeout: float) -> bool:
    """Wait until a client of the answer's node has seen its server go; whether one did."""
    return wait(lambda: not current().order("ready").get("value"), timeout, "the node to lose a server", 0.05)


def parts(value: Any, count: int) -> list[Any]:
    """The parts of a value handed to check(), if there are as many; else it stands for the first, and the rest lack."""
    return value if isinstance(value, list) and len(value) == count else [value, *[None] * (count - 1)]


def expect_value(text: str, given: Any, wanted: Any, hint: str, points: int = 1) -> bool:
    """A value that was handed to check() is the right one; what was given is quoted in front of the hint."""
    return expect(text, given == wanted, f"You gave {shown(given)}. {hint}", points)


def expect_type(name: str, types: list[str], interface: Any, hint: str = "") -> None:
    """What the answer has under a name is of one type, that of a class."""
    wanted = type_name(interface)
    require(f"`{name}` has the type `{wanted}`", types == [wanted], f"Its type is {', '.join(types)}.{hint}")


def nearest(wanted: str, names: list[str]) -> str:
    """The name that may have been meant, as the beginning of a hint."""
    near = difflib.get_close_matches(wanted, names, n=1, cutoff=0.5)
    return f"Did you mean `{near[0]}`? " if near else ""
