"""Causes in callbacks, timers, service calls and actions; and whether a callback can be called at all."""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Sequence
from typing import Any

from course_kit.ros.causes.raised import Raised, Rule, a

# What a callback is called with, by the function that takes it.
GIVEN: dict[str, list[tuple[str, ...]]] = {
    "create_timer": [()],
    "create_subscription": [("message",), ("message", "info")],
    "create_service": [("request", "response")],
    "ActionServer": [("goal_handle",)],
}
ORDER = {
    "create_timer": "create_timer(0.5, self.tick)",
    "create_subscription": "create_subscription(String, 'chatter', self.heard, 10)",
    "create_service": "create_service(AddTwoInts, 'add', self.add)",
    "ActionServer": "ActionServer(self, Fibonacci, 'fibonacci', self.execute)",
}


def misfit(callback: Any, taker: str) -> str:
    """Why a callback that is handed to `create_timer` or its like cannot be called, and the cure; '' if it can."""
    if callback is None:
        return (
            f"{taker}() got None as its callback, as a method gives that is called right there: hand over the method "
            f"itself, without parentheses behind its name, as in {ORDER[taker]}"
        )
    if not callable(callback):
        return f"{taker}() got {_shown(callback)} where its callback belongs: write {ORDER[taker]}"
    if any(_takes(callback, len(given)) for given in GIVEN[taker]):
        return ""
    return _how_to_define(callback, GIVEN[taker][0])


def _shown(value: Any) -> str:
    text = repr(value)
    return f"{type(value).__name__} {text}" if len(text) < 30 else f"a value of the type {type(value).__name__}"


def _takes(callback: Any, count: int) -> bool:
    try:
        signature = inspect.signature(callback)
    except TypeError:
        return True
    except ValueError as error:  # of a builtin, which does not tell; or a method without any parameter
        return "invalid method signature" not in str(error)
    try:
        signature.bind(*range(count))
    except TypeError:
        return False
    return True


def _how_to_define(callback: Any, given: Sequence[str]) -> str:
    while isinstance(callback, functools.partial):
        callback = callback.func
    name = getattr(callback, "__name__", type(callback).__name__)
    wanted = ", ".join(given)
    if name == "<lambda>":
        return f"rclpy calls the callback with ({wanted}), which this lambda does not take: write lambda {wanted}: …"
    if not inspect.ismethod(callback):
        return f"rclpy calls {name}({wanted}), and it does not take that: write def {name}({wanted}):"
    parameters = list(inspect.signature(callback.__func__).parameters)
    definition = f"def {name}({', '.join(('self', *given))}):"
    if parameters[:1] != ["self"]:
        return f"{name}() takes no self, and Python hands each method its object first: write {definition}"
    return f"rclpy calls {name}({wanted}), and it is defined as {name}({', '.join(parameters)}): write {definition}"


def _answer(raised: Raised, _: re.Match[str]) -> str:
    frame = raised.went_through("send_response")
    if frame is None:
        return ""
    response = frame.f_locals.get("response")
    if isinstance(response, type):
        return "The callback of a service returned a class: fill in the response that it was given, and return that"
    returned = "None" if response is None else f"a value of the type {type(response).__name__}"
    return f"The callback of a service returned {returned} in place of its response: end it with return response"


def _request(raised: Raised, _: re.Match[str]) -> str:
    frame = raised.went_through("call_async") or raised.went_through("call")
    request = frame.f_locals.get("request") if frame is not None else None
    if frame is None or frame.f_code.co_varnames[:2] != ("self", "request"):
        return ""
    kind = getattr(getattr(frame.f_locals["self"], "srv_type", None), "__name__", "AddTwoInts")
    if isinstance(request, type):
        return f"A call takes one request, and {request.__name__} is a class: make one with {kind}.Request()"
    return f"A call takes a request of its service's type, not {a(type(request).__name__)}: write {kind}.Request(…)"


def _goal(raised: Raised, _: re.Match[str]) -> str:
    frame = raised.went_through("send_goal_async")
    if frame is None:
        return ""
    kind = getattr(getattr(frame.f_locals.get("self"), "_action_type", None), "__name__", "Fibonacci")
    return f"A goal is a message of its action, not this value: write send_goal_async({kind}.Goal(…))"


def _feedback(raised: Raised, _: re.Match[str]) -> str:
    frame = raised.went_through("publish_feedback")
    return "" if frame is None else "Feedback is a message of its action: make one, as with Fibonacci.Feedback()"


def _period(raised: Raised, _: re.Match[str]) -> str:
    if raised.went_through("create_timer") is None:
        return ""
    return f"The period of a timer is a number of seconds, and comes first: write {ORDER['create_timer']}"


def _result_too_early(raised: Raised, _: re.Match[str]) -> str:
    if ".result()" not in raised.line:
        return ""
    return "result() of a future is None until the answer has come: await the future, or use a done callback"


RULES: tuple[Rule, ...] = (
    ("TypeError", r"^$", _answer),
    ("TypeError", r"^$", _request),
    ("TypeError", r"^$", _goal),
    ("TypeError", r"^$", _feedback),
    (
        "TypeError",
        r"Client\.call(?:_async)?\(\) takes 2 positional arguments",
        "A call takes one request, whose fields hold the values: write AddTwoInts.Request(a=1, b=2)",
    ),
    (
        "AttributeError",
        r"'Future' object has no attribute '(\w+)'",
        r"call_async() gives a future at once, and \1 comes with the response: await the future in an async def "
        r"callback, or wait_for(future) in a cell",
    ),
    ("AttributeError", r"'NoneType' object has no attribute", _result_too_early),
    (
        "AssertionError",
        r"The 'result' field must be a sub message of type '(\w+)_Result'",
        r"The execute callback of an action returned something else than its result: end it with return \1.Result(…)",
    ),
    ("TypeError|ValueError|RCLError", r"float|timer period must be non-negative", _period),
)
# How lines begin that rclpy logs; and their cause.
LOGGED = (
    (
        "Goal state not set, assuming aborted",
        "The execute callback of an action returned without saying how it went: call goal_handle.succeed() before",
    ),
)
