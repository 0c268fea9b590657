"""A ROS domain for each user of a machine, that no other user gets while one of the user's processes has it.

They hold it together, by a port of the domain that DDS leaves free: Linux lets the processes of one user share a port,
nobody else's join them, and frees it when the last one ends. So there is no file, and nothing to take back.
The number of the domain names other ports of the user as well, see ports_of().
As quick as the rest of activation: no module is imported that costs more than loading it.
"""

from __future__ import annotations

import _socket
import os

DOMAINS = range(1, 102)  # never everybody's default of 0; above, the ports are those that Linux gives to any program
PORT_BASE, DOMAIN_GAIN = 7400, 250
UNUSED = 5  # of a domain's ports; DDS has 0 and 1, and those from 10 on
FLOWS_BELOW = 400  # the first port of a unique network flow is so far below Fast DDS's port base
FLOWS = 40  # ports of a user for unique network flows; each context needs one
SHARED_MEMORY, PORT_FILE = "/dev/shm", "fastrtps_port"

_locks: dict[int, int] = {}  # the domains that this process holds, each with its socket's descriptor


def take(uid: int, given: str | None = None) -> str:
    """The domain of this user, held for as long as this process lives; `given` is that of the process's parent.

    The one that the user's other processes hold, else the first free one from 1 + uid % 100 on. Those in which another
    user has left ports in shared memory come last. With 101 users at once the next one shares a domain.
    """
    first = 1 + uid % 100
    ordered = [*range(first, DOMAINS.stop), *range(DOMAINS.start, first)]
    if given is not None and given.isascii() and given.isdigit():
        _hold(int(given))
        return given
    ordered.sort(key=_left_by_others(uid).__contains__)
    return str(next(filter(_hold, [*_held_by(uid), *ordered]), first))


def hold_over_restart() -> str:
    """Hold the domain also while this process replaces itself; return the value for after_restart().

    Else another user who starts at that moment takes the domain, and both have it.
    """
    for lock in _locks.values():
        os.set_inheritable(lock, True)
    return " ".join(map(str, [os.getpid(), *_locks.values()]))


def after_restart(value: str) -> None:
    """Let programs that this process starts not inherit the locks from before its restart."""
    process, *locks = map(int, value.split())
    if process == os.getpid():  # else the value is that of a parent
        for lock in locks:
            os.set_inheritable(lock, False)


def ports_of(domain: str) -> dict[str, str]:
    """The variables by which Fast DDS's profile gives the user of a domain ports of their own.

    rmw_fastrtps wants a unique network flow for each context, and Fast DDS takes the first free port from 400 below its
    port base on, in UDP and in shared memory, in every domain alike: 7000, 7001, … for all users of a machine. With a
    lower base, and offsets higher by as much, those ports are the user's alone and all others are where DDS has them.
    A profile can only put digits behind a variable, so the offsets are in tens.
    """
    lower = FLOWS * (int(domain) % DOMAINS.stop)
    return {
        "COURSE_KIT_PORT_BASE": str(PORT_BASE - lower),
        "COURSE_KIT_PORT_OFFSET": str(lower // 10),
        "COURSE_KIT_PORT_OFFSET_NEXT": str(lower // 10 + 1),
    }


def _hold(domain: int) -> bool:
    """Hold a domain together with the user's other processes; False if another user's hold it."""
    if domain in _locks:
        return True
    lock = _socket.socket(_socket.AF_INET, _socket.SOCK_DGRAM)
    try:
        lock.setsockopt(_socket.SOL_SOCKET, _socket.SO_REUSEPORT, 1)
        lock.bind(("127.0.0.1", _port(domain)))
    except (OSError, OverflowError):
        lock.close()
        return False
    _locks[domain] = lock.detach()  # it stays open until the process ends
    return True


def _port(domain: int) -> int:
    return PORT_BASE + DOMAIN_GAIN * domain + UNUSED


def _held_by(uid: int) -> list[int]:
    """The domains that processes of a user hold."""
    domains = {f"0100007F:{_port(domain):04X}".encode(): domain for domain in DOMAINS}
    try:
        with open("/proc/net/udp", "rb") as table:
            rows = [line.split() for line in table][1:]
    except OSError:
        return []
    return [domains[row[1]] for row in rows if row[7] == str(uid).encode() and row[1] in domains]


def _left_by_others(uid: int) -> set[int]:
    """The domains some of whose ports in shared memory are another user's, dead or alive."""
    found = set()
    for name in os.listdir(SHARED_MEMORY) if os.path.isdir(SHARED_MEMORY) else ():
        number = name[len(PORT_FILE) :].partition("_")[0]
        if name.startswith(PORT_FILE) and number.isdecimal():
            try:
                owner = os.stat(f"{SHARED_MEMORY}/{name}").st_uid
            except OSError:  # it has gone
                continue
            if owner != uid:
                found.add(_domain_of_port(int(number)))
    return found


def _domain_of_port(port: int) -> int:
    """The domain that a port belongs to, and its user's unique network flows."""
    if port >= PORT_BASE:
        return (port - PORT_BASE) // DOMAIN_GAIN
    return -((port - PORT_BASE + FLOWS_BELOW) // FLOWS)
