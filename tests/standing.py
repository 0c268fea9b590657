"""How this process stands in the graph, for the report of a failure: a deaf one is told from a slow one by it."""

from __future__ import annotations

import sys
from pathlib import Path

from course_kit.base.shutdown.shared_memory import FOLDER

LONGEST = 500  # characters of the names of nodes


def standing() -> str:
    """Say which ports of shared memory it has, which of them nobody else finds any more, and which nodes it knows."""
    try:
        ports = sorted({port_of(line) for line in Path("/proc/self/maps").read_text().splitlines() if is_port(line)})
        return "\n".join([*ports, *known_nodes()]) if ports else ""
    except Exception as error:  # ROS may end meanwhile, and a report that fails would end the run
        return repr(error)


def is_port(line: str) -> bool:
    return f" {FOLDER}/fastrtps_port" in line


def port_of(line: str) -> str:
    """A line of /proc/<process>/maps in words: a port whose file was removed is one that others do not find."""
    inode, path = line.split(maxsplit=5)[4:]
    name = Path(path.removesuffix(" (deleted)"))
    if not path.endswith(" (deleted)"):
        return f"{name.name} {inode}"
    return f"{name.name} {inode}, removed{f', made anew as {name.stat().st_ino}' if name.exists() else ''}"


def known_nodes() -> list[str]:
    """A line with the nodes that the node of the instruments knows, if it is there."""
    instruments = sys.modules.get("course_kit.ros.subscriptions.observer_node")
    node = instruments.present() if instruments else None
    if node is None:
        return []
    return [f"Nodes known in domain {node.context.get_domain_id()}: {sorted(node.get_node_names())}"[:LONGEST]]
