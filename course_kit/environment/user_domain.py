"""A ROS domain for each user of a machine, that no other user gets while one of the user's processes has it.

They hold it together, by a port of the domain that DDS leaves free: Linux lets the processes of one user share a port,
nobody else's join them, and frees it when the last one ends. So there is no file, and nothing to take back.
As quick as the rest of activation: no module is imported that costs more than loading it.
"""

from __future__ import annotations

import _socket

DOMAINS = range(1, 102)  # never everybody's default of 0; above, the ports are those that Linux gives to any program
PORT_BASE, DOMAIN_GAIN = 7400, 250
UNUSED = 5  # of a domain's ports; DDS has 0 and 1, and those from 10 on


def take(uid: int, given: str | None = None) -> str:
    """The domain of this user, held for as long as this process lives; `given` is that of the process's parent.

    The one that the user's other processes hold, else the first free one from 1 + uid % 100 on. With 101 users at once
    the next one shares a domain.
    """
    first = 1 + uid % 100
    ordered = [*range(first, DOMAINS.stop), *range(DOMAINS.start, first)]
    if given is not None and given.isascii() and given.isdigit():
        _hold(int(given))
        return given
    return str(next(filter(_hold, [*_held_by(uid), *ordered]), first))


def _hold(domain: int) -> bool:
    """Hold a domain together with the user's other processes; False if another user's hold it."""
    lock = _socket.socket(_socket.AF_INET, _socket.SOCK_DGRAM)
    try:
        lock.setsockopt(_socket.SOL_SOCKET, _socket.SO_REUSEPORT, 1)
        lock.bind(("127.0.0.1", _port(domain)))
    except (OSError, OverflowError):
        lock.close()
        return False
    lock.detach()  # it stays open until the process ends
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
