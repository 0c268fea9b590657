"""Asks the participants of this machine to announce themselves, in the words of RTPS, which all DDS speak.

Fast DDS announces a new participant before it listens, so of those that run already some answer too early, and they
answer once: it hears of them when their next regular announcement comes, with DDS as it is by default up to 3 s later.
But they answer whoever is new to them. So one more is announced, who has nothing and whose lease ends at once, and who
hears where the participant hears that missed the answers. Pure: imports no ROS.
"""

from __future__ import annotations

import os
import socket
import struct
from collections.abc import Iterable, Mapping

from course_kit.ros.private_api.fastdds_parts import VENDOR, sockets_of

LOOPBACK = "127.0.0.1"
VERSION = bytes([2, 2])
LEASE = (0, 2**31)  # seconds, and parts of 2**32: half a second
READS_ANNOUNCEMENTS = 1 << 1  # among the endpoints of a participant: all that it has
# Ids of the standard: who announces and hears participants, the participant itself.
WRITER, READER, PARTICIPANT = (bytes.fromhex(number) for number in ("000100c2", "000100c7", "000001c1"))
INFO_LITTLE_ENDIAN, DATA, WITH_DATA = b"\x00\x03\x00\x00", 0x15, 0x05
UDPV4, SENTINEL = 1, struct.pack("<HH", 1, 0)


def ask_all_to_announce(listening: Mapping[int, str]) -> None:
    """Have all participants of a domain tell of themselves to those of this process.

    `listening` is what participants_listening() gives.
    """
    sockets = sockets_of("self")
    own = {port for port, number in listening.items() if number in sockets}
    for port in own:
        ask_to_announce(listening.keys() - own, hears=port)


def ask_to_announce(ports: Iterable[int], hears: int) -> None:
    """Have the participants that hear of others on these ports tell of themselves to who hears on the port `hears`."""
    message = announcement(os.urandom(10), hears)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        for port in ports:
            asking.sendto(message, (LOOPBACK, port))


def announcement(number: bytes, port: int) -> bytes:
    """What a participant says that has this number, of 10 bytes, and hears on this port."""
    prefix = VENDOR + number
    locator = struct.pack("<iI12x4s", UDPV4, port, socket.inet_aton(LOOPBACK))
    parameters = {
        0x0015: VERSION + bytes(2),
        0x0016: VENDOR + bytes(2),
        0x0050: prefix + PARTICIPANT,
        0x0032: locator,  # where it hears of participants
        0x0031: locator,  # where it hears all else
        0x0002: struct.pack("<iI", *LEASE),
        0x0058: struct.pack("<I", READS_ANNOUNCEMENTS),
    }
    listed = b"".join(struct.pack("<HH", key, len(value)) + value for key, value in parameters.items())
    sample = READER + WRITER + struct.pack("<iI", 0, 1) + INFO_LITTLE_ENDIAN + listed + SENTINEL
    body = struct.pack("<HH", 0, 16) + sample
    return b"RTPS" + VERSION + VENDOR + prefix + struct.pack("<BBH", DATA, WITH_DATA, len(body)) + body
