"""Who on another host reaches the course's nodes: nobody, unless the user chooses SUBNET. Two network namespaces."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from course_kit.exercises.domains import TEST_DOMAINS
from course_kit.ros.private_api.fastdds_parts import participant_ports
from tests.benchmark.child import PROFILES

HERE, THERE = "10.77.0.1", "10.77.0.2"
DOMAIN = 42
LOOPBACK, EVERYWHERE = "0100007F", "00000000"  # as /proc/net/udp writes them
pytestmark = [
    pytest.mark.skipif(os.getuid() != 0, reason="only root makes network namespaces, which are the two hosts"),
    pytest.mark.skipif(shutil.which("ip") is None, reason="`ip` is not installed: apt-get install iproute2"),
    pytest.mark.timeout(180),
]
# A kernel's node, a checker with its test domain, a command, a program that was started.
VICTIM = """
import os, sys
from course_kit import check, run, start, wait_for
from course_kit import TurtleSim
run(TurtleSim)
program = start("ros2 run turtlesim turtlesim_node --ros-args -r __ns:=/started")
echo = start("ros2 topic echo /started/turtle1/pose turtlesim/msg/Pose")
verdict = check("setup-1", (int(os.environ["ROS_DOMAIN_ID"]), os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"]))
wait_for(lambda: echo.says("linear_velocity"), timeout=60)
print(str(verdict).splitlines()[0], flush=True)
sys.stdin.read()
"""
ATTACKER = """
import json, sys, time
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from turtlesim.msg import Pose
from turtlesim.srv import Kill

def until(condition, seconds):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        for executor in executors:
            executor.spin_once(timeout_sec=0.05)

nodes, executors = [], []
for domain in json.loads(sys.argv[1]):
    context = Context()
    context.init(domain_id=domain)
    nodes.append(rclpy.create_node("attacker", context=context, enable_rosout=False, start_parameter_services=False))
    executors.append(SingleThreadedExecutor(context=context))
    executors[-1].add_node(nodes[-1])
poses = []
nodes[0].create_subscription(Pose, "/turtle1/pose", poses.append, 10)
kill = nodes[0].create_client(Kill, "/kill")


def names():
    found = {f"{space}/{name}" for node in nodes for name, space in node.get_node_names_and_namespaces()}
    return sorted(name for name in found if "attacker" not in name)


wanted = {"//turtlesim", "/started/turtlesim"}
until(lambda: poses and kill.service_is_ready() and wanted.issubset(names()), float(sys.argv[2]))
answer = kill.call_async(Kill.Request(name="turtle1"))
until(answer.done, 3.0)
print(json.dumps({"nodes": names(), "poses": len(poses), "killed": answer.done()}))
"""


@pytest.fixture
def hosts() -> Iterator[tuple[str, str]]:
    """Two network namespaces that can send packets to each other."""
    here, there = (f"course-{os.getpid()}-{name}" for name in ("here", "there"))
    ends = {here: (f"ck{os.getpid()}a"[-15:], HERE), there: (f"ck{os.getpid()}b"[-15:], THERE)}

    def ip(*words: str) -> None:
        subprocess.run(["ip", *words], check=True, capture_output=True, timeout=20)

    with contextlib.ExitStack() as stack:
        for host in ends:
            ip("netns", "add", host)
            stack.callback(ip, "netns", "del", host)
        ip("link", "add", ends[here][0], "type", "veth", "peer", "name", ends[there][0])
        for host, (device, address) in ends.items():
            ip("link", "set", device, "netns", host)
            ip("-n", host, "addr", "add", f"{address}/24", "dev", device)
            for name in (device, "lo"):
                ip("-n", host, "link", "set", name, "up")
        yield here, there


@contextlib.contextmanager
def victim(host: str, folder: Path, reach: str) -> Iterator[None]:
    """A user of the course on this host; all is there when the block begins."""
    environ = {k: v for k, v in os.environ.items() if k not in ("ROS_LOCALHOST_ONLY", "FASTRTPS_DEFAULT_PROFILES_FILE")}
    environ |= {"ROS_DOMAIN_ID": str(DOMAIN), "XDG_STATE_HOME": str(folder), "ROS_AUTOMATIC_DISCOVERY_RANGE": reach}
    # Shared memory of one's own, too: two hosts have none in common.
    script = 'mount -t tmpfs tmpfs /dev/shm && exec "$@"'
    command = ["ip", "netns", "exec", host, "unshare", "-m", "sh", "-c", script, "sh", sys.executable, "-c", VICTIM]
    with subprocess.Popen(
        command, env=environ, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None and process.stdout is not None
        try:
            assert process.stdout.readline().startswith("setup-1")
            yield
        finally:
            process.stdin.close()
            process.wait(30)


def attack(host: str, seconds: float) -> dict[str, Any]:
    """What one on the other host gets, who knows the address, the domain and the test domains."""
    environ = dict(os.environ) | {"FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILES["stock"]), "ROS_STATIC_PEERS": HERE}
    environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "SUBNET"
    environ.pop("ROS_LOCALHOST_ONLY", None)
    domains = json.dumps([DOMAIN, TEST_DOMAINS[0]])
    command = ["ip", "netns", "exec", host, sys.executable, "-c", ATTACKER, domains, str(seconds)]
    done = subprocess.run(command, env=environ, capture_output=True, text=True, timeout=90)
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def addresses(host: str) -> set[str]:
    """The addresses at which participants listen on this host."""
    ports = {*participant_ports(DOMAIN), *participant_ports(TEST_DOMAINS[0])}
    read = subprocess.run(["ip", "netns", "exec", host, "cat", "/proc/net/udp"], capture_output=True, text=True)
    ends = [line.split()[1].split(":") for line in read.stdout.splitlines()[1:]]
    listening = [address for address, port in ends if int(port, 16) in ports]
    assert len(listening) >= 8  # two of each: kernel, checker, the test domain of each, programs
    return set(listening)


def test_by_default_nobody_on_another_host_reaches_a_node(hosts: tuple[str, str], tmp_path: Path) -> None:
    with victim(hosts[0], tmp_path, "LOCALHOST"):
        assert attack(hosts[1], 8.0) == {"nodes": [], "poses": 0, "killed": False}
        assert addresses(hosts[0]) == {LOOPBACK}


@pytest.mark.slow("the same again, with SUBNET")
def test_with_subnet_other_hosts_read_and_call(hosts: tuple[str, str], tmp_path: Path) -> None:
    with victim(hosts[0], tmp_path, "SUBNET"):
        found = attack(hosts[1], 30.0)
        assert {"//turtlesim", "/started/turtlesim"} <= set(found["nodes"])
        assert found["poses"] and found["killed"]
        assert EVERYWHERE in addresses(hosts[0])
