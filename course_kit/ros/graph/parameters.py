"""The parameters of all nodes of a graph, asked for at once: a node that does not answer delays no other."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from typing import Any

from rclpy.node import Node
from rclpy.parameter import Parameter as RclpyParameter
from rclpy.parameter import parameter_value_to_python

from course_kit.base.polling import wait_until
from course_kit.ros.graph import graph
from course_kit.ros.graph.snapshot import Parameter, Snapshot
from course_kit.ros.subscriptions.clients import client_of

TIMEOUT = 2.0  # seconds for all nodes to answer
# Every node has these; QoS overrides are drawn as the QoS itself.
EVERYWHERE = frozenset({"use_sim_time", "start_type_description_service"})
OVERRIDES = "qos_overrides."


def with_parameters(shown: Snapshot, node: Node, hidden: bool = False) -> Snapshot:
    """The snapshot with the parameters of its nodes; None for those that have no such service or do not answer.

    `node` asks; it must be spun meanwhile. Left out unless `hidden`: those that every node has, where they have their
    usual values.
    """
    from rcl_interfaces.srv import GetParameters, ListParameters

    served = graph.services(node, with_hidden=True)
    # Where two nodes share a name nobody can tell which of them answers.
    asked = [n.name for n in shown.nodes if n.count == 1 and f"{n.name}/list_parameters" in served]
    listed = _ask(node, ListParameters, "list_parameters", {name: ListParameters.Request() for name in asked})
    names = {name: sorted(answer.result.names) for name, answer in listed.items()}
    requests = {name: GetParameters.Request(names=of_node) for name, of_node in names.items()}
    values = _ask(node, GetParameters, "get_parameters", requests)
    found = {name: _parameters(names[name], answer.values, hidden) for name, answer in values.items()}
    return replace(shown, nodes=tuple(replace(one, parameters=found.get(one.name)) for one in shown.nodes))


def _parameters(names: list[str], values: Any, hidden: bool) -> tuple[Parameter, ...]:
    made = []
    for name, value in zip(names, values, strict=False):
        if not hidden and (name.startswith(OVERRIDES) or (name in EVERYWHERE and value.bool_value == (name[0] == "s"))):
            continue
        python = parameter_value_to_python(value)
        kind = RclpyParameter.Type(value.type).name.lower().replace("_", " ")
        text = str(list(python)) if value.type > 4 else str(python)
        made.append(Parameter(name, kind, text))
    return tuple(made)


def _ask(node: Node, service_type: Any, service: str, requests: dict[str, Any]) -> dict[str, Any]:
    """The answers by node; those that did not come in time are missing."""
    futures: dict[str, Any] = {}
    with ExitStack() as stack:
        clients = {name: stack.enter_context(client_of(node, service_type, f"{name}/{service}")) for name in requests}

        def all_answered() -> bool:
            for name, client in clients.items():
                if name not in futures and client.service_is_ready():
                    futures[name] = client.call_async(requests[name])
            return len(futures) == len(clients) and all(future.done() for future in futures.values())

        wait_until(all_answered, TIMEOUT)
        done = {name: future for name, future in list(futures.items()) if future.done()}
        return {name: answer for name, future in done.items() if (answer := future.result()) is not None}
