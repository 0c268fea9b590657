"""Causes in messages, their fields and their types, and in what publishers and subscriptions are made with."""

from __future__ import annotations

import importlib
import pkgutil
import re
from typing import Any

from course_kit.ros.causes.raised import Raised, Rule, a, enumerated, fields, filled, nearest, shown

PUBLISHER = "create_publisher(String, 'chatter', 10)"
SUBSCRIPTION = "create_subscription(String, 'chatter', self.heard, 10)"


def _not_what_is_published(raised: Raised, found: re.Match[str]) -> str:
    wanted, got = (one.rsplit(".", 1)[-1] for one in found.groups())
    frame = raised.went_through("publish")
    message = frame.f_locals.get("msg") if frame is not None else None
    if isinstance(message, type):
        return f"publish() sends a message, and {message.__name__} is the class of them: write {filled(message)}"
    sent = frame.f_locals["self"].msg_type if frame is not None else None
    written = filled(sent) if isinstance(sent, type) else f"{wanted}(…)"
    if fields(message):
        return f"This publisher was made for {wanted} and cannot send {a(got)}: make it for {got}, or publish {written}"
    return f"publish() sends a message of the type {wanted}, not {a(got)}: write publish({written})"


def _positional(raised: Raised, found: re.Match[str]) -> str:
    interface = raised.named(found[1])
    if not isinstance(interface, type) or not fields(interface):
        return ""
    return f"The fields of a message are given by name: write {filled(interface)}"


def _no_such_field(raised: Raised, found: re.Match[str]) -> str:
    name, wanted = found.groups()
    message = raised.instance(name)
    if not fields(message):
        return ""
    inside = [one for one in fields(message) if wanted in fields(getattr(message, one, None))]
    if inside:
        return f"{name} has no field {wanted} itself, its {inside[0]} has: write .{inside[0]}.{wanted}"
    return f"{name} has no field {wanted}; it has {enumerated(fields(message))}"


def _no_such_argument(raised: Raised, found: re.Match[str]) -> str:
    frame = raised.innermost
    message = type(frame.f_locals["self"]) if frame is not None and "self" in frame.f_locals else None
    if not fields(message) or message is None:
        return ""
    return f"{message.__name__} has no field {found[1]}; it has {enumerated(fields(message))}"


def _given(raised: Raised) -> Any:
    frame = raised.innermost
    return frame.f_locals.get("value") if frame is not None else None


def _wrong_type(raised: Raised, found: re.Match[str]) -> str:
    given, (field, wanted) = _given(raised), found.groups()
    cure = {"str": "str(…)", "int": "int(…)", "bool": "True or False"}.get(wanted, f"{wanted}(…)")
    if wanted == "float" and isinstance(given, int):
        cure = f"{given}.0"
    return f"The field {field} is {a(wanted)} and got {shown(given)}: write {cure}"


def _wrong_part(raised: Raised, found: re.Match[str]) -> str:
    given, (field, wanted) = _given(raised), found.groups()
    if isinstance(given, type):
        return f"The field {field} takes {a(wanted)}, and this is a class: write {given.__name__}(), with parentheses"
    return f"The field {field} is a message itself, {a(wanted)}, and got {shown(given)}: set its fields, or make one"


def _no_list(raised: Raised, found: re.Match[str]) -> str:
    frame = raised.innermost
    there = frame.f_locals if frame is not None else {}
    handed = there.get("kwargs", {frame.f_code.co_name: there.get("value")} if frame is not None else {})
    for field, given in handed.items():
        if field in fields(there.get("self")) and type(given).__name__ == found[1]:
            return f"The field {field} takes a list, and got {shown(given)}: write [{given!r}]"
    return ""


def _wrong_number(raised: Raised, found: re.Match[str]) -> str:
    return f"The field {found[1]} takes a whole number {found[2]}, and got {shown(_given(raised))}"


def _no_type(raised: Raised, found: re.Match[str]) -> str:
    kind = found[1]
    if kind == "module":
        return "A type is a class, and this is a module: write from std_msgs.msg import String, and hand over String"
    if kind == "type":
        return f"A topic carries messages, and this is no type of them: write String of std_msgs.msg, as in {PUBLISHER}"
    return f"A type of messages, services or actions belongs here, not {a(kind)}: the type comes first, then the name"


def _other_type(raised: Raised, found: re.Match[str]) -> str:
    needed, given, name = found[1], found[2], found[3]
    if f".{'msg' if needed == 'message' else 'srv'}." in given:
        return ""
    of_topics = "create_publisher() and create_subscription() take"
    taker = {"message": of_topics, "service": "create_service() and create_client() take"}.get(needed, "this takes")
    kinds = {"msg": "message", "srv": "service", "action": "action"}
    is_of = next((kind for part, kind in kinds.items() if f".{part}." in given), "other")
    return f"{name} is a type of {is_of}s, and {taker} a type of {needed}s"


def _order(raised: Raised, _: re.Match[str]) -> str:
    for taker, example in (
        ("create_publisher", PUBLISHER),
        ("create_subscription", SUBSCRIPTION),
        ("create_client", "create_client(AddTwoInts, 'add')"),
        ("create_service", "create_service(AddTwoInts, 'add', self.add)"),
    ):
        if raised.went_through(taker) is not None:
            return f"{taker}() takes the type first, then the name as text: write {example}"
    return ""


def _qos(raised: Raised, found: re.Match[str]) -> str:
    example = SUBSCRIPTION if raised.went_through("create_subscription") is not None else PUBLISHER
    return (
        f"The QoS, the last argument, is the depth of a queue or a QoSProfile, and got {a(found[1])}: write {example}, "
        f"or QoSProfile(depth=10, …) in the place of 10"
    )


def _module(raised: Raised, found: re.Match[str]) -> str:
    meant = nearest(found[1], (module.name for module in pkgutil.iter_modules()))
    return f"There is no package {found[1]}: did you mean {meant}?" if meant else ""


def _not_in_module(raised: Raised, found: re.Match[str]) -> str:
    name, module = found.groups()
    package, _, part = module.partition(".")
    others = {one: _names(f"{package}.{one}") for one in ("msg", "srv", "action") if one != part}
    if place := next((one for one, names in others.items() if name in names), ""):
        return f"{name} is in {package}.{place}: write from {package}.{place} import {name}"
    if meant := nearest(name, _names(module)):
        return f"{module} has no {name}: did you mean {meant}?"
    return ""


def _names(module: str) -> list[str]:
    try:
        return [one for one in dir(importlib.import_module(module)) if not one.startswith("_")]
    except ImportError:
        return []


RULES: tuple[Rule, ...] = (
    ("TypeError", r"Expected <class '([\w.]+)'>, got <class '([\w.]+)'>", _not_what_is_published),
    ("TypeError", r"^(\w+)\.__init__\(\) takes 1 positional argument but", _positional),
    ("AttributeError", r"'(\w+)' object has no attribute '(\w+)'", _no_such_field),
    (
        "AttributeError",
        r"'(\w+)' object attribute '(\w+)' is read-only",
        r"A cell has set \2 of the class \1 itself, for want of the parentheses in \1(): restart the kernel, and write "
        r"\1() there",
    ),
    ("AssertionError", r"Invalid arguments passed to constructor: (\w+)", _no_such_argument),
    ("AssertionError", r"The '(\w+)' field must be of type '(\w+)'", _wrong_type),
    ("AssertionError", r"The '(\w+)' field must be a sub message of type '(\w+)'", _wrong_part),
    ("AssertionError", r"The '(\w+)' field must be an (?:unsigned )?integer (in \[.*\])", _wrong_number),
    (
        "AssertionError",
        r"The '(\w+)' field must be a set or sequence.*and each value of type '(\w+)'",
        r"The field \1 takes a list, whose values are of the type \2",
    ),
    ("TypeError", r"'(\w+)' object is not iterable", _no_list),
    (
        "TypeError",
        r"missing 1 required positional argument: 'qos_profile'",
        "The QoS is missing, the last argument: end the call with , 10 as the depth of its queue",
    ),
    ("TypeError", r"rclpy_resolve_name\(\): incompatible", _order),
    ("TypeError", r"Expected QoSProfile or int, but received <class '([\w.]+)'>", _qos),
    ("AttributeError", r"type object '(\w+)' has no attribute '_TYPE_SUPPORT'", _no_type),
    ("RuntimeError", r"The (\w+) type provided is not valid \(<class '([\w.]+?(\w+))'>\)", _other_type),
    ("ModuleNotFoundError", r"No module named '(\w+)", _module),
    ("ImportError", r"cannot import name '(\w+)' from '([\w.]+)'", _not_in_module),
)
