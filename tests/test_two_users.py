"""Ann and Bob on one machine: Bob's messages to Ann's checker never count, and the two do not meet in /dev/shm."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit.exercises.domains import TEST_DOMAINS
from course_kit.setup.environment.activation import PROFILE
from tests.grading.handed_in import references
from tests.other_users import another_machine, command_of

ANN, BOB = 3042, 3142
DOMAINS = (43, *TEST_DOMAINS[:8])  # Ann's, and the test domains that she can get
EXERCISE = "topics-1"
pytestmark = [
    pytest.mark.skipif(os.getuid() != 0, reason="only root can be several users"),
    pytest.mark.timeout(200),
]
# Only UDP: of shared memory Linux keeps another user's processes away.
UDP = """<?xml version="1.0" encoding="UTF-8" ?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <transport_descriptors>
    <transport_descriptor><transport_id>udp</transport_id><type>UDPv4</type></transport_descriptor>
  </transport_descriptors>
  <participant profile_name="udp" is_default_profile="true">
    <rtps><userTransports><transport_id>udp</transport_id></userTransports><useBuiltinTransports>false</useBuiltinTransports></rtps>
  </participant>
</profiles>
"""
BOBS = """
import sys, threading, time
import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import Int32

contexts, publishers, heard = [], [], set()
for domain in map(int, sys.argv[1:]):
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    node = rclpy.create_node("bob", context=context, enable_rosout=False)
    publishers.append(node.create_publisher(Int32, "/countdown", 10))
    hear = lambda message, domain=domain: message.data == 77 or heard.add(domain)
    node.create_subscription(Int32, "/countdown", hear, 10)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    contexts.append(context)
print("ready", flush=True)
threading.Thread(target=lambda: sys.stdin.read() or contexts.clear(), daemon=True).start()
while contexts:
    for publisher in publishers:
        publisher.publish(Int32(data=77))
    time.sleep(0.02)
print(sorted(heard), flush=True)
"""
ANNS = """
import time
from rclpy.node import Node
from course_kit import check, run
{answer}
check("{exercise}")
"""


EMPTY = """
class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
run(Countdown)
"""


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder that both may reach: those of pytest are root's."""
    with tempfile.TemporaryDirectory(prefix="course-users-", dir="/tmp") as made:
        os.chmod(made, 0o777)
        yield Path(made)


@pytest.mark.parametrize("is_right", [True, False])
def test_what_another_user_sends_is_told_and_not_counted(folder: Path, is_right: bool) -> None:
    home = folder / "home"
    home.mkdir()
    home.chmod(0o777)
    (folder / "udp.xml").write_text(UDP)
    bobs = {
        "FASTRTPS_DEFAULT_PROFILES_FILE": f"{folder}/udp.xml",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
        "ROS_STATIC_PEERS": "127.0.0.1",
    }
    noise = command_of(BOB, folder, sys.executable, "-c", BOBS, *map(str, DOMAINS), environment=bobs)
    with subprocess.Popen(noise, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as bob:
        assert bob.stdout is not None
        assert bob.stdout.readline() == "ready\n"
        answer = references("topics")[EXERCISE] if is_right else EMPTY
        work = command_of(ANN, folder, sys.executable, "-c", ANNS.format(answer=answer, exercise=EXERCISE))
        ann = subprocess.run(work, capture_output=True, text=True, timeout=120)
        heard = bob.communicate("", timeout=30)[0]
    assert f"{EXERCISE} · Count down: 0 of 2 points" in ann.stdout, (ann.stdout, ann.stderr, heard)
    assert not is_right or "/bob of another process or context" in ann.stdout


NODE = """
import sys
import rclpy
rclpy.init()
node = rclpy.create_node("node")
print("ready", flush=True)
sys.stdin.read()
"""
# A port as a process that goes on can have it: its segment and its mutex are gone, and the lock is held.
LOSE_PORTS = "cd /dev/shm && rm -f sem.fastrtps_port*_mutex && ls | grep -x 'fastrtps_port[0-9]*' | xargs rm"


@pytest.mark.skipif(shutil.which("ip") is None, reason="`ip` is not installed: apt-get install iproute2")
@pytest.mark.parametrize("is_course", [True, False], ids=["course", "one port base for all"])
def test_a_users_node_does_not_meet_the_locks_of_another_user(folder: Path, is_course: bool) -> None:
    environment = {}
    if not is_course:
        whole = Path(PROFILE).read_text()
        (folder / "shared.xml").write_text(re.sub("<port>.*</port>", "", whole, flags=re.DOTALL))
        environment["FASTRTPS_DEFAULT_PROFILES_FILE"] = f"{folder}/shared.xml"
    nodes = {}
    for user in (ANN, BOB):
        own = {**environment, "HOME": f"{folder}/{user}"}
        nodes[user] = command_of(user, folder, sys.executable, "-c", NODE, environment=own)
    with another_machine() as machine:
        pipe = subprocess.PIPE
        with subprocess.Popen([*machine.prefix, *nodes[ANN]], stdin=pipe, stdout=pipe, text=True) as anns:
            assert anns.stdout is not None
            assert anns.stdout.readline() == "ready\n"
            subprocess.run([*machine.prefix, "sh", "-c", LOSE_PORTS], check=True, timeout=20)
            bobs = subprocess.run([*machine.prefix, *nodes[BOB]], input="", capture_output=True, text=True, timeout=60)
            anns.communicate("", timeout=30)
    printed = bobs.stdout + bobs.stderr
    assert printed.count("open_and_lock_file failed") == (0 if is_course else 2), printed
    assert printed.endswith("ready\n")
    assert not is_course or printed == "ready\n"
