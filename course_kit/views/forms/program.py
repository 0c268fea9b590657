"""The values of a form as a program of plain rclpy, for a file or a cell. Imports no ROS itself."""

from __future__ import annotations

import math
from dataclasses import dataclass
from string import Template
from typing import Any

from course_kit.views.forms.fields import NOW, Field, changed
from course_kit.views.forms.interface import ACTION, SERVICE, Interface

WIDTH = 88  # of a line, where it can be broken
STEP = " " * 4

_ONCE = """\
import time

import rclpy
$imports

rclpy.init()
node = rclpy.create_node("sender")
publisher = node.create_publisher($type, "$name", 10)
message = $message
for _ in range(100):  # what is sent before a subscription has been found is lost
    if publisher.get_subscription_count():
        break
    time.sleep(0.1)
publisher.publish(message)
publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=1))
node.destroy_node()
"""
_AT_RATE = """\
import rclpy
$imports

rclpy.init()
node = rclpy.create_node("sender")
publisher = node.create_publisher($type, "$name", 10)


def tick():
    message = $message
    publisher.publish(message)


node.create_timer(1 / $rate, tick)
rclpy.spin(node)  # until Ctrl-C, or the stop button of the notebook
"""
_CALL = """\
import rclpy
$imports

rclpy.init()
node = rclpy.create_node("caller")
client = node.create_client($type, "$name")
request = $message
if not client.wait_for_service(timeout_sec=10.0):
    raise TimeoutError("nobody offers $name")
future = client.call_async(request)
rclpy.spin_until_future_complete(node, future, timeout_sec=10.0)
print(future.result())
node.destroy_node()
"""
_SEND_GOAL = """\
import rclpy
from rclpy.action import ActionClient
$imports

rclpy.init()
node = rclpy.create_node("goal_sender")
client = ActionClient(node, $type, "$name")
goal = $message
if not client.wait_for_server(timeout_sec=10.0):
    raise TimeoutError("nobody offers $name")
sending = client.send_goal_async(goal, feedback_callback=lambda message: print(message.feedback))
rclpy.spin_until_future_complete(node, sending, timeout_sec=10.0)
handle = sending.result()
if handle is None or not handle.accepted:
    raise RuntimeError("$name has not accepted the goal")
ending = handle.get_result_async()
rclpy.spin_until_future_complete(node, ending)  # takes as long as the goal
print(ending.result().result)
client.destroy()
node.destroy_node()
"""


def program(interface: Interface, value: Any, rate: float | None = None) -> str:
    """The program that sends a value, as `read()` gives it; a topic's once, or at a rate in Hz."""
    imports = _Imports()
    name = imports.name(interface.type_name)
    arguments = _arguments(interface.root, changed(interface.root, value), imports)
    sent = _Call(f"{name}.{interface.part}" if interface.part else name, arguments)
    template = {SERVICE: _CALL, ACTION: _SEND_GOAL}.get(interface.noun, _ONCE if rate is None else _AT_RATE)
    line = next(line for line in template.splitlines() if "$message" in line)
    indent = line[: len(line) - len(line.lstrip())]
    return Template(template).substitute(
        imports="\n".join(imports.lines()),
        type=name,
        name=interface.name,
        rate=f"{rate or 0:g}",
        message=_laid_out(sent, indent, WIDTH - len(line) + len("$message")),
    )


@dataclass(frozen=True)
class _Call:
    """A call of a constructor with keywords; without a name a list, whose elements have no keywords."""

    name: str
    arguments: tuple[tuple[str, Any], ...]

    @property
    def ends(self) -> tuple[str, str]:
        return (f"{self.name}(", ")") if self.name else ("[", "]")


class _Imports:
    """The classes that a program names."""

    def __init__(self) -> None:
        self._modules: dict[str, str] = {}  # by the name of the class

    def name(self, type_name: str) -> str:
        """How a type such as 'std_msgs/msg/String' is called: with its package if another class has its name."""
        package, kind, name = type_name.split("/")
        module = f"{package}.{kind}"
        return name if self._modules.setdefault(name, module) == module else self._qualified(module, name)

    def _qualified(self, module: str, name: str) -> str:
        self._modules.setdefault(f"{module}.", module)
        return f"{module}.{name}"

    def lines(self) -> list[str]:
        """The imports, sorted."""
        plain: dict[str, list[str]] = {}
        for name, module in sorted(self._modules.items()):
            if not name.endswith("."):
                plain.setdefault(module, []).append(name)
        whole = [f"import {module}" for name, module in sorted(self._modules.items()) if name.endswith(".")]
        return [*whole, *(f"from {module} import {', '.join(plain[module])}" for module in sorted(plain))]


def _arguments(message: Field, value: dict[str, Any], imports: _Imports) -> tuple[tuple[str, Any], ...]:
    by_name = {one.name: one for one in message.fields}
    return tuple((name, _expression(by_name[name], inner, imports)) for name, inner in value.items())


def _expression(one: Field, value: Any, imports: _Imports) -> Any:
    if one.kind == "message":
        return _Call(imports.name(one.type.replace("/", "/msg/")), _arguments(one, value, imports))
    if one.kind == "array" and one.element is not None:
        return _Call("", tuple(("", _expression(one.element, item, imports)) for item in value))
    if one.kind == "time":
        if value == NOW:
            return "node.get_clock().now().to_msg()"
        name = imports.name(one.type.replace("/", "/msg/"))
        return _Call(name, tuple((key, repr(number)) for key, number in value.items() if number))
    if one.type == "byte":
        return repr(bytes([value]))
    if isinstance(value, float) and not math.isfinite(value):
        return f'float("{value}")'
    return repr(value)


def _flat(expression: Any) -> str:
    if isinstance(expression, str):
        return expression
    begin, end = expression.ends
    return begin + ", ".join(f"{key}={_flat(one)}" if key else _flat(one) for key, one in expression.arguments) + end


def _laid_out(expression: Any, indent: str, room: int) -> str:
    """An expression on one line where it fits into so many characters, else an argument a line."""
    flat = _flat(expression)
    if isinstance(expression, str) or len(flat) <= room:
        return flat
    begin, end = expression.ends
    inner = indent + STEP
    lines = [begin]
    for key, one in expression.arguments:
        head = f"{inner}{key}=" if key else inner
        lines.append(f"{head}{_laid_out(one, inner, WIDTH - len(head) - 1)},")
    return "\n".join([*lines, indent + end])
