"""Reads from the source of a class how it uses ROS: endpoints with their QoS, timers, calls."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import rclpy.qos
from rclpy.action import ActionClient, ActionServer
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.client import Client
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from rclpy.task import Future
from rclpy.timer import Timer

# {what is called: (what it makes, the places of its type, its name and its QoS)}
MAKERS = {
    "create_publisher": ("publisher", 0, 1, 2),
    "create_subscription": ("subscription", 0, 1, 3),
    "create_service": ("service", 0, 1, None),
    "create_client": ("client", 0, 1, None),
    "ActionServer": ("action server", 1, 2, None),
    "ActionClient": ("action client", 1, 2, None),
}
KEYWORDS = ("msg_type", "srv_type", "action_type"), ("topic", "srv_name", "action_name"), ("qos_profile",)
OWN_GROUP = "the node's own callback group"
# Keywords that can as well be places.
PLACES = {name for names in KEYWORDS for name in names} | {"callback", "execute_callback", "timer_period_sec"}
FIELDS = {"stamp"}  # of messages, though goal handles have them too
LOGGING = {"debug", "info", "warning", "warn", "error", "fatal"}


@dataclass(frozen=True)
class Endpoint:
    """A publisher, a subscription, a service, …, as a class makes it."""

    kind: str
    name: str  # of its topic, service or action; empty if it is no plain text
    type: str
    qos: tuple[str, ...] = ()  # reliability and durability, as far as the source says them
    group: str = OWN_GROUP


@cache
def ros_names() -> frozenset[str]:
    """What nodes, their endpoints, futures and goals offer."""
    offering = Node, Publisher, Subscription, Client, Timer, Future, ActionClient, ActionServer
    offered = {name for kind in (*offering, ClientGoalHandle, ServerGoalHandle) for name in dir(kind)}
    return frozenset(name for name in offered if not name.startswith("_") and name not in {*MAKERS, *FIELDS})


class RosCalls:
    """What one class does with ROS. `values` are the notebook's variables, which may be QoS profiles."""

    def __init__(self, source: str, values: Mapping[str, Any] | None = None) -> None:
        self._tree = ast.parse(source)
        self._values = {**vars(rclpy.qos), **(values or {})}
        self._calls = [node for node in ast.walk(self._tree) if isinstance(node, ast.Call)]
        self._assigned = {
            target.id: node.value
            for node in ast.walk(self._tree)
            if isinstance(node, ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name)
        }

    @property
    def node_name(self) -> str:
        """The name that the node gives itself; empty if it cannot be told."""
        made = (call.args for call in self._calls if _called(call) == "__init__")
        texts = (arg.value for args in made for arg in args if isinstance(arg, ast.Constant))
        return next((text for text in texts if isinstance(text, str)), "")

    @cached_property
    def endpoints(self) -> list[Endpoint]:
        """All that it makes, in order."""
        return list(self._endpoints())

    def _endpoints(self) -> Iterator[Endpoint]:
        for call in self._calls:
            if maker := MAKERS.get(_called(call)):
                kind, *places = maker
                parts = [_argument(call, place, names) for place, names in zip(places, KEYWORDS, strict=True)]
                message_type = ast.unparse(parts[0]) if parts[0] is not None else ""
                name = str(parts[1].value).removeprefix("/") if isinstance(parts[1], ast.Constant) else ""
                group = _argument(call, None, ("callback_group",))
                yield Endpoint(kind, name, message_type.rpartition(".")[2], self._qos(parts[2]), self._group(group))

    def _qos(self, expression: ast.expr | None) -> tuple[str, ...]:
        """Reliability and durability; empty if the source does not say them."""
        match self._known(expression):
            case ast.Constant(value=int()):
                return "RELIABLE", "VOLATILE"
            case QoSProfile() as profile:
                return profile.reliability.name, profile.durability.name
            case ast.Call(keywords=keywords) as call if _called(call) == "QoSProfile":
                given = {keyword.arg: ast.unparse(keyword.value).rpartition(".")[2] for keyword in keywords}
                return given.get("reliability", "RELIABLE"), given.get("durability", "VOLATILE")
        return ()

    def _group(self, expression: ast.expr | None) -> str:
        known = self._known(expression)
        return f"a {_called(known)}" if isinstance(known, ast.Call) else OWN_GROUP if known is None else ""

    def _known(self, expression: Any) -> Any:
        """What a name stands for: an expression of the class, or a value of the notebook."""
        if isinstance(expression, ast.Name | ast.Attribute):
            name = ast.unparse(expression).rpartition(".")[2]
            return self._assigned.get(name, self._values.get(name, expression))
        return expression

    @property
    def periods(self) -> set[float]:
        """The periods of its timers, of those that are written as numbers."""
        periods = (_argument(call, 0, ("timer_period_sec",)) for call in self._calls if _called(call) == "create_timer")
        numbers = (period.value for period in periods if isinstance(period, ast.Constant))
        return {float(number) for number in numbers if isinstance(number, int | float)}

    @property
    def is_async(self) -> bool:
        """True if it has coroutines."""
        return any(isinstance(node, ast.AsyncFunctionDef) for node in ast.walk(self._tree))

    @property
    def uses(self) -> set[str]:
        """What it uses of rclpy, and `time.sleep`; not what it calls so itself."""
        attributes = {node.attr for node in ast.walk(self._tree) if isinstance(node, ast.Attribute)}
        used = attributes & ros_names() - self._own_names
        sleeps = any(ast.unparse(call.func) == "time.sleep" for call in self._calls)
        return used | ({"time.sleep"} if sleeps else set())

    @property
    def _own_names(self) -> set[str]:
        """What the class itself calls something: its methods and attributes."""
        nodes = list(ast.walk(self._tree))
        methods = {node.name for node in nodes if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}
        stored = (node for node in nodes if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store))
        return (methods | {node.attr for node in stored}) - {"__init__"}

    @property
    def options(self) -> set[str]:
        """The keywords that it gives to rclpy, such as `cancel_callback`."""
        heeded = (ros_names() | set(MAKERS) | LOGGING | {"__init__", "create_timer"}) - self._own_names
        given = {keyword.arg for call in self._calls if _called(call) in heeded for keyword in call.keywords}
        return {name for name in given if name and name not in {*PLACES, "callback_group", "timeout_sec"}}


def _called(call: ast.Call) -> str:
    return ast.unparse(call.func).rpartition(".")[2]


def _argument(call: ast.Call, place: int | None, names: tuple[str, ...]) -> ast.expr | None:
    given = next((keyword.value for keyword in call.keywords if keyword.arg in names), None)
    return call.args[place] if given is None and place is not None and place < len(call.args) else given
