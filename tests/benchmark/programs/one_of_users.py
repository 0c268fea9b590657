"""A user of a machine that has many: `one_of_users NAME SECONDS LAUNCH_FILE` starts and ends ROS again and again.

Reports how many rounds there were, what was lost, how many nodes of strangers were seen and what Fast DDS complained
of. All users publish on one topic; what a user hears must be the user's own. The launch file starts NAME's turtlesim.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from tests.benchmark.programs.reporting import report
from tests.kernel import Kernel
from tests.waiting import wait_until

COMPLAINT = "RTPS_TRANSPORT_SHM Error"
TIMEOUT = 90.0
CELL = "from rclpy.node import Node\nfrom course_kit import run, stop\nrun(Node, '{name}_kernel')"


class User:
    """A user, with a record of all that was done and seen."""

    def __init__(self, name: str, launch_file: str) -> None:
        self.name = name
        self.launch_file = launch_file
        self.rounds = 0
        self.lost: list[str] = []
        self.strangers: set[str] = set()
        self.printed: list[str] = []

    def ros2(self, *words: str) -> str:
        """Run a command to its end; return its output."""
        try:
            done = subprocess.run(["ros2", *words], capture_output=True, text=True, timeout=TIMEOUT)
        except subprocess.TimeoutExpired as late:
            self.lost.append(f"the end of {words}: {late.stdout!r} {late.stderr!r}")
            return ""
        self.printed += [done.stdout, done.stderr]
        return done.stdout

    @contextmanager
    def running(self, *words: str) -> Iterator[None]:
        """A command that goes on until the block ends."""
        command = ["ros2", *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
            try:
                yield
            finally:
                process.terminate()
                self.printed.append(process.communicate(timeout=TIMEOUT)[0])

    def live_once(self) -> None:
        """Work in a kernel, publish and listen in terminals, launch."""
        self.rounds += 1
        kernel = Kernel()
        try:
            cell = kernel.run(CELL.format(name=self.name), TIMEOUT)
            self.expect(f"{self.name}_kernel", kernel.text(cell))
            self.publish()
            self.launch()
            if self.rounds % 2:
                kernel.run("stop()", TIMEOUT)  # every other kernel is killed in the midst
            streams = [m["content"]["text"] for m in kernel.messages if m["msg_type"] == "stream"]
            self.printed += streams
        finally:
            kernel.close()

    def publish(self) -> None:
        word = f"{self.name}-{self.rounds}"
        with self.running("topic", "pub", "/word", "std_msgs/msg/String", f"data: {word}", "-r", "10"):
            self.expect(f"data: {word}\n---\n", self.ros2("topic", "echo", "--once", "/word", "std_msgs/msg/String"))
            self.expect("/word\n", self.ros2("topic", "list"))

    def launch(self) -> None:
        with self.running("launch", self.launch_file, f"name:={self.name}"):
            wait_until(self.sees_turtlesim, "the turtlesim", timeout=TIMEOUT)

    def sees_turtlesim(self) -> bool:
        nodes = self.ros2("node", "list").split()
        self.strangers.update(node for node in nodes if not node.startswith(f"/{self.name}"))
        return f"/{self.name}/turtlesim" in nodes

    def expect(self, part: str, whole: str) -> None:
        if part not in whole:
            self.lost.append(f"{part!r} in {whole!r}")


def main(name: str, seconds: str, launch_file: str) -> None:
    user, end = User(name, launch_file), time.monotonic() + float(seconds)
    while time.monotonic() < end:
        user.live_once()
    complaints = [line for line in "\n".join(user.printed).splitlines() if COMPLAINT in line]
    report(rounds=user.rounds, lost=user.lost, strangers=sorted(user.strangers), complaints=complaints)


if __name__ == "__main__":
    main(*sys.argv[1:])
