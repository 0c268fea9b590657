"""A storm of processes that join ROS and are killed, beside nodes that have to live through it.

    python -m tests.programs.storm COUNT    prints as JSON how it ended: see Outcome

It is run with a /dev/shm of its own, where it does no harm to others.
"""

from __future__ import annotations

import json
import os
import random
import select
import signal
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from course_kit.base.shutdown.shared_memory import FOLDER
from tests.domains import reserve_domain

LIVING = 8
DOMAINS = 3
AT_ONCE = 6  # of those that are killed
LONGEST_LIFE = 0.5  # seconds, from the start of ROS on
PATIENCE = 20.0  # seconds for the living to hear each other
HANGS = 30.0  # seconds after which a program counts as one that hangs
MADE = "made"

# One of the living: says each number that it hears from each other one, and a number of its own ten times a second.
LIVES = """
import sys
import rclpy
from std_msgs.msg import String
from course_kit.ros.program import program
from rclpy.node import Node

class Living(Node):
    def __init__(self):
        super().__init__(sys.argv[1])
        self.publisher = self.create_publisher(String, "/said", 10)
        self.create_subscription(String, "/said", self.hear, 10)
        self.create_timer(0.1, lambda: self.publisher.publish(String(data=sys.argv[1])))

    def hear(self, message):
        print(message.data, flush=True)

with program("living", Living, [""]) as (node, executor, asked):
    while not asked:
        executor.spin_once(timeout_sec=0.2)
"""
# One that is killed. It is forked from a process that has all imported, so that its life is one in ROS.
STORM = """
import os, signal, sys
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
def live():
    rclpy.init()
    node = Node("dies")
    publisher = node.create_publisher(String, "/said", 10)
    node.create_subscription(String, "/said", lambda message: None, 10)
    while True:
        publisher.publish(String(data="dying"))
        rclpy.spin_once(node, timeout_sec=0.01)
signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the dead
for line in sys.stdin:
    domain = line.strip()
    child = os.fork()
    if child == 0:
        os.environ["ROS_DOMAIN_ID"] = domain
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Fast DDS writes its errors there
        live()
    print(child, flush=True)
"""
NEW = """
import sys, time
from course_kit.ros.spinning import context
from rclpy.node import Node
began = time.monotonic()
context.start()
Node("new")
print(time.monotonic() - began, flush=True)
"""


@dataclass
class Outcome:
    """How a storm ended."""

    killed: int
    seconds: float
    dead_segments: int  # that were found, and healed by somebody
    new_node: list[float]  # seconds until a new node is made afterwards, in each domain
    deaf: list[str]  # pairs of living nodes one of which hears the other no more
    hanging: int  # processes that do not end when they are asked to


class Living:
    """One of the nodes that live through it."""

    def __init__(self, name: str, domain: int) -> None:
        self.name, self.domain = name, domain
        environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        self.process = subprocess.Popen([sys.executable, "-c", LIVES, name], stdout=subprocess.PIPE, env=environment)

    def heard(self, seconds: float) -> set[str]:
        """The names that it hears from now on, until so many seconds are over."""
        assert self.process.stdout is not None
        descriptor, deadline = self.process.stdout.fileno(), time.monotonic() + seconds
        os.set_blocking(descriptor, False)
        text = b""
        while (left := deadline - time.monotonic()) > 0:
            if select.select([descriptor], [], [], left)[0]:
                if not (data := os.read(descriptor, 1 << 20)):
                    break
                text += data
        return {line.decode() for line in text.split(b"\n")[1:]}


def _deaf(living: list[Living]) -> list[str]:
    """The pairs of which one does not hear the other within PATIENCE."""
    deadline = time.monotonic() + PATIENCE
    deaf = {(one.name, other.name) for one in living for other in living if one.domain == other.domain}
    for one in living:
        one.heard(0.05)  # of before
    while deaf and time.monotonic() < deadline:
        for one in living:
            names = one.heard(0.3)
            deaf -= {(one.name, name) for name in names}
    return [f"{one} does not hear {other}" for one, other in sorted(deaf)]


def storm(count: int) -> Outcome:
    """Have so many processes join and be killed, and see what that does to those that live."""
    domains = [reserve_domain() for _ in range(DOMAINS)]
    living = [Living(f"living_{number}", domains[number % DOMAINS]) for number in range(LIVING)]
    assert not (deaf := _deaf(living)), deaf
    source = subprocess.Popen(
        [sys.executable, "-c", STORM], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    assert source.stdin is not None and source.stdout is not None
    began, ends, dead = time.monotonic(), list[tuple[float, int]](), set[int]()
    for number in range(count):
        source.stdin.write(f"{domains[number % DOMAINS]}\n".encode())
        source.stdin.flush()
        child = int(source.stdout.readline())
        ends.append((time.monotonic() + random.uniform(0.0, LONGEST_LIFE), child))
        while len(ends) >= AT_ONCE:
            _kill(ends)
            dead |= _dead()
            for one in living:
                one.heard(0.001)  # a full pipe would hold it
    while ends:
        _kill(ends)
    dead |= _dead()
    seconds = time.monotonic() - began
    source.kill()
    source.wait()
    new = [_new_node(domain) for domain in domains]
    deaf = _deaf(living)
    for one in living:
        one.process.send_signal(signal.SIGTERM)
    hanging = 0
    for one in living:
        try:
            one.process.wait(HANGS)
        except subprocess.TimeoutExpired:
            hanging += 1
            one.process.kill()
    return Outcome(count, seconds, len(dead), new, deaf, hanging + sum(one == HANGS for one in new))


def _kill(ends: list[tuple[float, int]]) -> None:
    """Kill the one whose time comes first, when it has come."""
    ends.sort()
    at, child = ends.pop(0)
    time.sleep(max(0.0, at - time.monotonic()))
    os.kill(child, signal.SIGKILL)


def _dead() -> set[int]:
    """The files that are no ready segments, which the dead have left or which are being made."""
    found = set()
    for path in FOLDER.glob("fastrtps_*"):
        if not path.name.endswith("_el"):
            try:
                state = _state(path)
                if state is None or state < 2:
                    found.add(path.stat().st_ino)
            except OSError:  # it has just been removed
                pass
    return found


def _state(path: Path) -> int | None:
    with open(path, "rb") as file:
        word = file.read(4)
    return int.from_bytes(word, "little") if word else None


def _new_node(domain: int) -> float:
    """The seconds that a new node takes, without what is imported; HANGS if it does not get there."""
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    try:
        done = subprocess.run([sys.executable, "-c", NEW], capture_output=True, env=environment, timeout=HANGS)
    except subprocess.TimeoutExpired:
        return HANGS
    return float(done.stdout.split()[-1]) if done.stdout else HANGS  # Fast DDS prints its errors before


if __name__ == "__main__":
    print(json.dumps(asdict(storm(int(sys.argv[1])))))
