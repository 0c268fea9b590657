"""Which other process of this domain runs a node of the same name: everyone hears the two as one."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

import psutil  # type: ignore[import-untyped]

from course_kit.base.programs.process_ids import own_ids
from course_kit.ros.graph import discovery
from course_kit.ros.graph.graph import NodeName
from course_kit.ros.private_api.fastdds_parts import Origin
from course_kit.ros.subscriptions import observer_node

NOTEBOOK = "JPY_SESSION_NAME"  # in the environment of a kernel: the notebook that it runs


def told(name: str) -> str:
    """Who else runs a node of this full name, and the cure, in a sentence; '' if nobody does."""
    for pid in _elsewhere(name):
        who, cure = _described(pid)
        return (
            f"{who} runs a node {name} as well, in this domain, and others take the two for one: {cure}, or give one "
            f"of them another name."
        )
    return ""


def _elsewhere(name: str) -> Iterator[int | None]:
    """The processes that have announced a node of this name beside the one meant; None for one that is not known."""
    own = observer_node.present()
    if own is None:
        return
    wanted = (NodeName.of(name).name, NodeName.of(name).namespace)
    mine = (own.get_name(), own.get_namespace())
    announced = discovery.of(own).announced()
    here = next((Origin.of(one.participant) for one in announced if mine in one.nodes), None)
    for one in announced:
        if one.nodes.count(wanted) <= (mine in one.nodes):
            continue
        origin = Origin.of(one.participant)
        if origin is None or here is None or origin.host != here.host:
            yield None
        else:  # a killed process is announced for a while
            yield from [pid for pid in psutil.pids() if origin.pid_bits in {id & 0xFFFF for id in own_ids([pid])}][:1]


def _described(pid: int | None) -> tuple[str, str]:
    if pid is None:
        return "Another program", "end it"
    if pid == os.getpid():
        return "This notebook", "call destroy_node() of the one that you made in a cell"
    with contextlib.suppress(OSError):
        for entry in Path(f"/proc/{pid}/environ").read_bytes().split(b"\0"):
            if entry.startswith(NOTEBOOK.encode() + b"="):
                notebook = Path(os.fsdecode(entry.split(b"=", 1)[1])).name
                return f"Another notebook, {notebook},", "call stop() there"
    with contextlib.suppress(psutil.Error):
        if any("ipykernel" in word for word in psutil.Process(pid).cmdline()):
            return "Another notebook", "call stop() there"
    return f"Another program, process {pid},", "end it"
