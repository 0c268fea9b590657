"""What a `ros2` command loads before it does something: each module more is time that a user waits."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from tests.benchmark.child import Program
from tests.domains import own_domain
from tests.ros2_command import COMMAND

# Loaded by rclpy or by the messages' classes, or by what the course does elsewhere.
HEAVY = {"asyncio", "em", "IPython", "lark", "matplotlib", "numpy", "psutil", "rclpy.action", "rosidl_pycommon"}
TRIGGER = "std_srvs/srv/Trigger"
UNUSED = {"course_kit.ros.causes.interfaces", "yaml.loader"}


def loaded_by(*words: str) -> set[str]:
    """The modules that a command line loads, and the packages that they are in."""
    command = [sys.executable, "-X", "importtime", *COMMAND[1:], *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    names = re.findall(r"^import time: .*\| +(\S+)$", done.stderr, re.MULTILINE)
    return {".".join(name.split(".")[:depth]) for name in names for depth in range(1, name.count(".") + 2)}


@pytest.mark.parametrize("words", ["topic list -t", "node list", "service list", "action list"])
def test_a_list_loads_nothing_that_it_does_not_need(words):
    with own_domain():
        loaded = loaded_by(*words.split())
    assert "rclpy.node" in loaded
    assert loaded & (HEAVY | UNUSED) == set()


@pytest.mark.parametrize(
    "words",
    [
        "param get /robot_0_0 use_sim_time",
        f"service call /robot_0_0/reset {TRIGGER}",
        "topic echo --once /robot_0_0/state",
        "topic pub --once -w 0 /cmd_vel geometry_msgs/msg/Twist",
    ],
)
def test_no_arrays_are_loaded_where_there_are_none(words):
    with own_domain() as domain, Program("full_graph", 0, 1, 1, domain=domain) as program:
        program.report()
        loaded = loaded_by(*words.split())
    assert "rcl_interfaces.srv._get_parameters" in loaded
    assert loaded & HEAVY == set()


@pytest.mark.parametrize(
    ("words", "verbs"),
    [
        ("topic list", set()),
        ("topic echo", {"topic.echo"}),
        ("topic hz", {"topic.hz_bw_delay"}),
        ("service type", set()),
        ("service call", {"service.call"}),
        ("action send_goal", {"action.send_goal"}),
        ("bag info", set()),
        ("bag play", {"bag.play"}),
        ("doctor hello", {"doctor.hello"}),
    ],
)
def test_a_verb_loads_no_other_verb(words, verbs):
    of_verbs = {"action.send_goal", "bag.play", "bag.record", "doctor.hello", "service.call", "service.echo"}
    of_verbs |= {"service.info", "topic.echo", "topic.pub", "topic.hz_bw_delay"}
    code = (
        f"import sys\nfrom course_kit.cli.ros2 import command\ncommand.parser_for({words.split()})\nprint(*sys.modules)"
    )
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60).stdout.split()
    assert {name for name in of_verbs if f"course_kit.cli.ros2.{name}" in loaded} == verbs
    assert f"course_kit.cli.ros2.{'.'.join(2 * words.split()[:1])}" in loaded


def test_a_parser_alone_loads_no_ros():
    loaded = loaded_by("topic", "pub", "--help")
    assert "argparse" in loaded
    assert loaded & (HEAVY | UNUSED | {"rclpy"}) == set()


# Says at the first import of what nodes are made of whether this process has joined the graph.
JOINED = """
import os, sys
from course_kit.ros.private_api.fastdds_parts import participants_listening
from course_kit.cli.ros2.command import main

class Look:
    def find_spec(self, name, path=None, target=None):
        if name == "rclpy.node":
            there = participants_listening(int(os.environ["ROS_DOMAIN_ID"]))
            print("joined" if there else "not yet", file=sys.stderr)

sys.meta_path.insert(0, Look())
sys.argv = ["ros2", *sys.argv[1:]]
main()
"""


@pytest.mark.parametrize("words", ["topic list", "node list -a", "topic echo /nothing", "param list"])
def test_the_graph_is_joined_before_the_rest_is_imported(words):
    with own_domain():
        command = [sys.executable, "-c", JOINED, *words.split()]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.stderr.splitlines()[0] == "joined"
    assert "_joining" not in done.stdout


LATER = """
import sys
from concurrent.futures import ThreadPoolExecutor
from course_kit.ros.private_api.import_parts import arrays_later, import_less

import_less()
import yaml
import yaml.error

assert "yaml.loader" not in sys.modules
with ThreadPoolExecutor() as pool:
    loads = list(pool.map(lambda _: yaml.safe_load, range(8)))
assert {load("[1, {a: b}]") == [1, {"a": "b"}] for load in loads} == {True}
from yaml import YAMLError

assert YAMLError is yaml.error.YAMLError and not hasattr(yaml, "nothing")

with arrays_later():
    from geometry_msgs.msg import PoseWithCovariance, Twist
Twist().linear.x = 1.0
assert "numpy" not in sys.modules
covariance = PoseWithCovariance().covariance
import numpy

assert type(covariance) is numpy.ndarray and len(covariance) == 36
"""


def test_what_is_loaded_later_is_whole_then():
    done = subprocess.run([sys.executable, "-c", LATER], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
