"""Checks of what messages travel over: the loopback interface, shared memory, the port of JupyterLab."""

from __future__ import annotations

import os
import shutil
import socket
from pathlib import Path

from course_kit.setup.environment.report import Check, fail, passed, warn

LOOPBACK = "127.0.0.1"
SHARED_MEMORY = Path("/dev/shm")
NEEDED_SHARED_MEMORY = 32  # MB: each process with nodes takes 0.6, images come on top
CONTAINERS_SHARED_MEMORY = 70  # MB: Docker gives 64 MiB unless it is told otherwise
LAB_PORTS = range(8888, 8939)  # JupyterLab tries the next ones when its own is taken
PACKET_TIMEOUT = 2.0


def loopback(address: str = LOOPBACK) -> Check:
    """A UDP packet from this machine to itself, as DDS sends them."""
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
            receiver.settimeout(PACKET_TIMEOUT)
            receiver.bind((address, 0))
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
                sender.sendto(b"course_kit", receiver.getsockname())
            receiver.recv(64)
    except OSError as error:
        reason = "nodes in different processes find each other through it; if it is up, a firewall may be in the way"
        return fail(f"no UDP packet gets through {address}: {error}", reason, "sudo ip link set lo up")
    return passed(f"a UDP packet gets through {address}")


def shared_memory(folder: Path = SHARED_MEMORY) -> Check:
    """Writable and large enough; DDS passes messages through it."""
    if not folder.is_dir() or not os.access(folder, os.W_OK | os.X_OK):
        what = "cannot be written" if folder.is_dir() else "is not there"
        reason = "DDS complains at every start and sends large messages the slow way, through UDP"
        return warn(f"{folder} {what}", reason, f"sudo mount -t tmpfs -o mode=1777,size=512m tmpfs {folder}")
    usage = shutil.disk_usage(folder)
    return shared_memory_space(folder, usage.free // 1_000_000, usage.total // 1_000_000)


def shared_memory_space(folder: Path, free: int, total: int) -> Check:
    """The same from figures in MB."""
    detail = f"{free} of {total} MB free in {folder}"
    if free >= NEEDED_SHARED_MEMORY:
        small = " (a container's default; enough for the course)" if total < CONTAINERS_SHARED_MEMORY else ""
        return passed(detail + small)
    reason = "each process with nodes takes 0.6 MB, and what a killed one held stays; without it DDS gets slow"
    return warn(detail, reason, ".venv/bin/fastdds shm clean, or give a container more: docker run --shm-size=512m")


def is_free(port: int, address: str = LOOPBACK) -> bool:
    """Return True if a server could listen there."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((address, port))
        except OSError:
            return False
    return True


def ports(candidates: range = LAB_PORTS) -> Check:
    """A port for JupyterLab: its own, else one of the next."""
    free = next((port for port in candidates if is_free(port)), None)
    if free is None:
        detail = f"{candidates[0]} to {candidates[-1]} are all taken"
        cure = "jupyter server list shows running ones: stop some, or: ./environment-check.sh lab --port=9999"
        return fail(detail, "JupyterLab has no port to listen on", cure)
    if free == candidates[0]:
        return passed(f"{free} is free for JupyterLab")
    return passed(f"{candidates[0]} is taken, JupyterLab will use {free}")
