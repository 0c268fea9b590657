"""Private parts of Fast DDS that the course reads: ids of endpoints, ports and announcements of participants.

The ports are those of the RTPS specification, the announcement is rmw_dds_common's; who made an id is a habit of
Fast DDS that each use tries on an id of its own process.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from course_kit.ros.private_api import NotAsExpected

GID_SIZE = 16  # bytes of an endpoint's id
PARTICIPANT_SIZE = 12  # bytes of an endpoint's id, the first, that are its participant's
VENDOR = b"\x01\x0f"  # with which its ids begin

# How RTPS computes the ports of a domain's participants: 2 for each, for discovery and for data.
PORT_BASE, DOMAIN_GAIN, PARTICIPANT_GAIN = 7400, 250, 2
DISCOVERY_OFFSET, DATA_OFFSET = 10, 11
PROCESSES, UDP = Path("/proc"), Path("/proc/net/udp")
LOOKS = 10  # at it, of which two in succession have to be equal


def participant_ports(domain: int) -> range:
    """The ports on which the participants of a domain may listen."""
    first = PORT_BASE + DOMAIN_GAIN * domain
    return range(first + DISCOVERY_OFFSET, first + DOMAIN_GAIN)


def participants_listening(domain: int, read: Callable[[], str] = UDP.read_text) -> dict[int, str] | None:
    """The ports on which the participants of a domain hear of others, each with the number of its socket.

    None where the kernel does not tell; `read` gives the text of /proc/net/udp.
    """
    try:
        ports = {int(address.rsplit(":", 1)[1], 16): inode for address, inode in _open_sockets(read)}
    except (OSError, ValueError, IndexError):
        return None
    gap = DATA_OFFSET - DISCOVERY_OFFSET
    candidates = participant_ports(domain)[::PARTICIPANT_GAIN]
    return {port: ports[port] for port in candidates if port in ports and port + gap in ports}


def sockets_of(process: int | str) -> set[str]:
    """The numbers of the sockets that a process has open; of a process that has ended, or is another user's, none."""
    found = set()
    with contextlib.suppress(OSError):
        for descriptor in Path(PROCESSES, str(process), "fd").iterdir():
            with contextlib.suppress(OSError):  # it was closed
                found.add(os.readlink(descriptor).removeprefix("socket:[").removesuffix("]"))
    return found


def processes_listening(domain: int) -> set[int]:
    """The ids of the processes that have a participant of the domain, of those that this user may look into."""
    sockets = set((participants_listening(domain) or {}).values())
    pids = [entry.name for entry in PROCESSES.iterdir() if entry.name.isdigit()] if sockets else []
    return {int(pid) for pid in pids if sockets & sockets_of(pid)}


def _open_sockets(read: Callable[[], str]) -> set[tuple[str, str]]:
    """The local address and the inode of each UDP socket.

    The kernel gives its table a page at a time and counts up to where it was: a socket that closes meanwhile shifts
    the rest, and one is left out. The closed one is missing the next time, so two equal looks have left out none.
    Raises OSError if no two are.
    """
    before: set[tuple[str, str]] | None = None
    for _ in range(LOOKS):
        rows = [line.split() for line in read().splitlines()[1:]]
        if (sockets := {(row[1], row[9]) for row in rows}) == before:
            return sockets
        before = sockets
    raise OSError("sockets are opened and closed all the time")


@dataclass(frozen=True)
class Origin:
    """What an endpoint's id says about where it comes from."""

    host: bytes
    pid_bits: int  # the lower 16 of the process id

    @staticmethod
    def of(gid: bytes) -> Origin | None:
        """Read an id of Fast DDS; None for another middleware's."""
        if gid[:2] != VENDOR:
            return None
        return Origin(bytes(gid[2:4]), int.from_bytes(gid[4:6], "little"))


@dataclass(frozen=True)
class Entities:
    """What one participant announces: its id, its nodes as (name, namespace), and the ids of all their endpoints."""

    participant: bytes
    nodes: tuple[tuple[str, str], ...]
    endpoints: frozenset[bytes]


def entities(data: bytes) -> Entities:
    """Read a serialised rmw_dds_common/msg/ParticipantEntitiesInfo; NotAsExpected if it is of another form.

    Read here, because the message's Python class loads numpy, which takes longer than all else that a list does.
    """
    place = 0

    def take(size: int) -> bytes:
        nonlocal place
        place += size
        if place > len(data):
            raise NotAsExpected("rmw_dds_common announces nodes in another form here")
        return data[place - size : place]

    def take_count() -> int:
        nonlocal place
        place += -place % 4
        return int.from_bytes(take(4), order)  # type: ignore[arg-type]

    def take_text() -> str:
        return take(take_count()).rstrip(b"\0").decode(errors="replace")

    order = "little" if take(4)[1] & 1 else "big"  # a header, whose size keeps the alignment of 4
    participant = take(GID_SIZE)
    nodes, ids = [], []
    for _ in range(take_count()):
        namespace, name = take_text(), take_text()
        nodes.append((name, namespace))
        for _ in range(2):  # its readers, its writers
            ids += [take(GID_SIZE) for _ in range(take_count())]
    if len(data) - place > 3:  # padding
        raise NotAsExpected("rmw_dds_common announces nodes in another form here")
    return Entities(participant[:PARTICIPANT_SIZE], tuple(nodes), frozenset(ids))
