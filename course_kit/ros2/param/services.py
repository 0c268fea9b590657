"""The parameter services of another node, each called once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError

SERVICE_TIMEOUT = 5.0  # seconds given to a node's parameter service to be found, as in the real command
ANSWER_TIMEOUT = 10.0  # seconds given to the node to answer

TYPE_NAMES = (
    "not set",
    "boolean",
    "integer",
    "double",
    "string",
    "byte array",
    "boolean array",
    "integer array",
    "double array",
    "string array",
)


def call(session: Session, service_type: Any, node_name: str, service: str, request: Any) -> Any:
    """Call a parameter service of a node; its response. Raises CommandError if the node does not answer."""
    from course_kit.watching.instruments import call as call_service

    name = f"{node_name}/{service}"
    try:
        return call_service(service_type, name, request, SERVICE_TIMEOUT, ANSWER_TIMEOUT, session.until)
    except LookupError:
        raise CommandError("Wait for service timed out") from None
    except TimeoutError as error:
        raise CommandError(f"Exception while calling service of node '{node_name}': {error}") from None


def list_parameters(session: Session, node_name: str, prefixes: Sequence[str] = ()) -> list[str]:
    """The names of a node's parameters, sorted."""
    from rcl_interfaces.srv import ListParameters

    request = ListParameters.Request(prefixes=list(prefixes))
    return sorted(call(session, ListParameters, node_name, "list_parameters", request).result.names)


def get_parameters(session: Session, node_name: str, names: Sequence[str]) -> list[Any]:
    """rcl_interfaces ParameterValues, one for each name; fewer if one is not declared."""
    from rcl_interfaces.srv import GetParameters

    request = GetParameters.Request(names=list(names))
    return list(call(session, GetParameters, node_name, "get_parameters", request).values)


def describe_parameters(session: Session, node_name: str, names: Sequence[str]) -> list[Any]:
    """rcl_interfaces ParameterDescriptors, one for each name that is declared."""
    from rcl_interfaces.srv import DescribeParameters

    request = DescribeParameters.Request(names=list(names))
    return list(call(session, DescribeParameters, node_name, "describe_parameters", request).descriptors)


def set_parameters(session: Session, node_name: str, parameters: Sequence[Any]) -> list[Any]:
    """Set rcl_interfaces Parameters; a SetParametersResult for each."""
    from rcl_interfaces.srv import SetParameters

    request = SetParameters.Request(parameters=list(parameters))
    return list(call(session, SetParameters, node_name, "set_parameters", request).results)
