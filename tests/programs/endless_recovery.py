"""The endless recovery of Fast DDS 2.14, into which a writer falls when a reader dies in the midst of a message.

    python -m tests.programs.endless_recovery GUARD TIMES    prints how many seconds each of so many recoveries lasted

A writer leaves out the ports that are out of order, then sends. If a port gets out of order between the two, the writer
recovers the message that the port's reader had begun to process: for ever (Fast DDS issue 6485). That moment is made
here: the writer waits for the port's mutex when its reader is dead and the port gets out of order.

GUARD is "itself" if the writer has the watchdog, "another" if this process has it, "nobody" to see the fault.
It is run with a /dev/shm of its own, where it does no harm to others.
"""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

from course_kit.base.shutdown import watchdog
from course_kit.base.shutdown.shared_memory import FOLDER
from tests.domains import reserve_domain
from tests.waiting import wait_until

NUMBER, FLAGS, MUTEX, LISTENER = 0x114, 0x12C, 0x5170, 0x5198  # places in a port of Fast DDS 2.14
IS_IN_ORDER, IS_PROCESSING = 1, 4  # bits there
AWAITED = 2  # a mutex that somebody waits for
LONGEST = 30.0  # seconds
LIBRARY = ctypes.CDLL(None)
# Publishes on and on, and counts in a file.
WRITER = """
import mmap, struct, sys
from course_kit.base.shutdown import watchdog
import rclpy
from std_msgs.msg import String
if sys.argv[2] == "itself":
    watchdog.begin()
rclpy.init()
node = rclpy.create_node("writer")
publisher = node.create_publisher(String, "/said", 10)
message = String(data="said")
count = 0
with open(sys.argv[1], "r+b") as file, mmap.mmap(file.fileno(), 8) as memory:
    while True:
        publisher.publish(message)
        count += 1
        struct.pack_into("Q", memory, 0, count)
"""
# Says when it hears the writer.
READER = """
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("reader")
node.create_subscription(String, "/said", lambda message: print(message.data, flush=True), 10)
rclpy.spin(node)
"""


class Port:
    """A port in shared memory."""

    def __init__(self, path: Path) -> None:
        with open(path, "r+b") as file:
            self._memory = mmap.mmap(file.fileno(), 0)
        self._mutex = (ctypes.c_char * 40).from_buffer(self._memory, MUTEX)

    def lock(self) -> None:
        LIBRARY.pthread_mutex_lock(self._mutex)

    @property
    def is_awaited(self) -> bool:
        return self._memory[MUTEX] == AWAITED

    @property
    def is_in_order(self) -> bool:
        return bool(self._memory[FLAGS] & IS_IN_ORDER)

    def unlock_out_of_order(self) -> None:
        """Leave it as that of a reader that died in the midst of a message."""
        self._memory[LISTENER] |= IS_PROCESSING
        self._memory[FLAGS] &= ~IS_IN_ORDER & 0xFF
        LIBRARY.pthread_mutex_unlock(self._mutex)


def recoveries(guard: str, times: int) -> list[float]:
    """Have so many writers recover; return the seconds that each recovery lasts. LONGEST is for ever, and the last.

    Each writer has its own domain. A writer makes the port of its dead reader anew and removes it with each message,
    and may remove the port of a new reader that takes the same one.
    """
    counted = FOLDER / "counted"
    if guard == "another":
        watchdog.begin()
    lasted: list[float] = []
    while len(lasted) < times and LONGEST not in lasted:
        domain = reserve_domain()
        counted.write_bytes(bytes(8))
        with process(WRITER, domain, str(counted), guard):
            ports = ports_of_dead_reader(domain)
            wait_until(partial(is_any_awaited, ports))
            for port in ports:
                port.unlock_out_of_order()
            lasted.append(stands_still(counted))
    return lasted


def is_any_awaited(ports: list[Port]) -> bool:
    return any(port.is_awaited for port in ports)


@contextmanager
def process(code: str, domain: int, *arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    command, environment = [sys.executable, "-c", code, *arguments], {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment) as made:
        try:
            yield made
        finally:
            made.kill()


def ports_of_dead_reader(domain: int) -> list[Port]:
    """The ports of a reader that was killed while it heard the writer; they are locked."""
    with process(READER, domain) as reader:
        assert reader.stdout is not None and reader.stdout.readline()
        ports = [Port(path) for path in read_by(reader.pid)]
        for port in ports:
            port.lock()
    return ports


def read_by(process: int) -> Iterator[Path]:
    """The ports that a process reads, by the locks that it has."""
    for link in Path(f"/proc/{process}/fd").iterdir():
        with suppress(OSError):
            name = os.readlink(link)
            if name.startswith(f"{FOLDER}/fastrtps_port") and name.endswith("_el"):
                yield Path(name.removesuffix("_el"))


def stands_still(counted: Path) -> float:
    """The seconds until the writer publishes again."""
    began, count = time.monotonic(), counted.read_bytes()
    while counted.read_bytes() == count and time.monotonic() - began < LONGEST:
        time.sleep(0.001)
    return min(time.monotonic() - began, LONGEST)


if __name__ == "__main__":
    print(json.dumps(recoveries(sys.argv[1], int(sys.argv[2]))))
