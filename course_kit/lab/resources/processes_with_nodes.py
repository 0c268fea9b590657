"""Which process a node lives in.

ROS does not say. Fast DDS does, by the way: the ids of a participant's publishers begin with its vendor, four digits
that stand for the machine, and the lower 16 bits of the process id. Whether that still holds is tried on this
process's own ids each time; a process is believed only if it has a port of the domain's participants open.
"""

from __future__ import annotations

import contextlib
import functools
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import psutil  # type: ignore[import-untyped]
from rclpy.node import Node

from course_kit.ros.graph import graph
from course_kit.ros.private_api.fastdds_parts import Origin, participant_ports
from course_kit.ros.subscriptions import observer_node, topics

OF_EVERY_NODE = ("/rosout", "/parameter_events")  # hardly a node is without a publisher on both
NOTEBOOK = "this notebook"
ELSEWHERE = "on another machine"
GONE = "process has ended"
UNKNOWN = "process not known"


@dataclass(frozen=True)
class NodeProcess:
    """A process and the ROS nodes in it; `pid` is None where it could not be found, and `program` says why."""

    program: str
    pid: int | None
    nodes: tuple[str, ...]  # full names, hidden ones left out

    @property
    def label(self) -> str:
        """What stands for it in tables and figures."""
        return f"{self.program} ({self.pid})" if self.pid is not None else self.program


def node_processes() -> list[NodeProcess]:
    """The processes in which the nodes of this domain live, this notebook first, each with its nodes."""
    node = observer_node.node()
    origins = _origins(node)
    own = _own_origin(node)
    found: dict[tuple[int | None, str], list[str]] = {}
    domain, place_of = node.context.get_domain_id(), functools.cache(_process_of)
    for name in graph.nodes(node):
        origin = origins.get(name.full_name)
        place = (None, UNKNOWN) if origin is None or own is None else place_of(origin, own, domain)
        found.setdefault(place, []).append(name.full_name)
    listed = [NodeProcess(program, pid, tuple(names)) for (pid, program), names in found.items()]
    return sorted(listed, key=lambda one: (one.program != NOTEBOOK, one.pid is None, one.nodes))


def _origins(node: Node) -> dict[str, Origin | None]:
    """Where each node comes from, by its full name. Of two nodes that share a name the last that is found."""
    return {
        topics.node_name(endpoint): Origin.of(bytes(endpoint.endpoint_gid))
        for topic in OF_EVERY_NODE
        for endpoint in node.get_publishers_info_by_topic(topic)
    }


def _own_origin(node: Node) -> Origin | None:
    """That of this process; None if ids do not say what they are expected to."""
    name = node.get_fully_qualified_name()
    own = _origins(node).get(name)
    return own if own is not None and own.pid_bits == os.getpid() & 0xFFFF else None


def _process_of(origin: Origin, own: Origin, domain: int) -> tuple[int | None, str]:
    if origin == own:
        return os.getpid(), NOTEBOOK
    if origin.host != own.host:
        return None, ELSEWHERE
    pids = [pid for pid in psutil.pids() if pid & 0xFFFF == origin.pid_bits]
    taking_part = [pid for pid in pids if listens(pid, domain)]
    if len(taking_part) != 1:
        return None, UNKNOWN if pids else GONE
    return taking_part[0], program_of(taking_part[0])


def listens(pid: int, domain: int) -> bool:
    """Return True if a process has a port of a domain's participants open; other users' processes are not known."""
    ports = participant_ports(domain)
    try:
        connections = psutil.Process(pid).net_connections("udp")
    except psutil.Error:
        return False
    return any(one.laddr and one.laddr.port in ports for one in connections)


def program_of(pid: int) -> str:
    """What a process runs, in a word: the script of a Python program, else the name of the program."""
    with contextlib.suppress(psutil.Error):
        return _program(psutil.Process(pid).cmdline()) or "process"
    return "process"


def _program(words: Iterable[str]) -> str:
    """The program in a command line; behind `python -m` the module, behind `python` the script."""
    line = [word for word in words if word]
    if not line:
        return ""
    name = Path(line[0]).name
    if not name.startswith("python"):
        return name
    for number, word in enumerate(line[1:], 1):
        if word == "-m" and number + 1 < len(line):
            module, *arguments = line[number + 1 :]
            if not module.startswith("course_kit."):
                return module
            # Of the course's own modules some are several programs, such as turtlesim_node.
            is_named = arguments and not arguments[0].startswith("-")
            return arguments[0] if is_named else module.rsplit(".", 1)[-1]
        if word == "-c":
            return name
        if not word.startswith("-"):
            return Path(word).name
    return name
