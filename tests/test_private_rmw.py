"""The contract with rmw and Fast DDS: what the course uses of them, and what it does where they are others."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from rclpy.node import Node

from course_kit.ros.private_api import NotAsExpected, package_version, rmw_parts
from course_kit.ros.private_api.fastdds_parts import Origin, entities, participants_listening
from course_kit.ros.private_api.rmw_parts import SERIES, SerializedSubscription
from course_kit.ros.spinning import context
from tests.waiting import wait_until

OPEN = 'SerializedSubscription(node, "ros_discovery_info", "rmw_dds_common", "ParticipantEntitiesInfo", 10)'
WITH_A_NODE = f"""
import ctypes, os
import rclpy
from rclpy.node import Node
from course_kit.ros.private_api import NotAsExpected, rmw_parts
from course_kit.ros.private_api.rmw_parts import SerializedSubscription
from course_kit.ros.graph import discovery
rclpy.init()
node = Node("sentry")

def open_and_take():
    opened = {OPEN}
    while opened.take() is None:
        pass

def with_one_field_more(name):
    plain = getattr(rmw_parts, name)
    class Changed(ctypes.Structure):
        _fields_ = (("new", ctypes.c_uint64), *plain._fields_)
        def __init__(self, *values):
            super().__init__(0, *values)
    setattr(rmw_parts, name, Changed)
"""


def child(code: str) -> subprocess.CompletedProcess[str]:
    """Run code in a process of its own; what it printed, once it has ended well."""
    done = subprocess.run([sys.executable, "-c", WITH_A_NODE + code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, (done.returncode, done.stderr)
    return done


@pytest.fixture
def node() -> Iterator[Node]:
    context.start()
    made = Node("sentry")
    yield made
    made.destroy_node()


def test_the_structures_of_the_installed_rmw_are_those_that_are_known(node):
    assert all(package_version(package).startswith(series) for package, series in SERIES.items())
    subscription = SerializedSubscription(node, "ros_discovery_info", "rmw_dds_common", "ParticipantEntitiesInfo", 10)
    sample = wait_until(subscription.take)
    subscription.close()
    announced = entities(sample.data)
    assert ("sentry", "/") in announced.nodes
    assert sample.publisher[:12] == announced.participant
    assert sample.received > 0


def test_ids_and_ports_of_the_installed_fast_dds_are_as_known(node):
    endpoints = node.get_publishers_info_by_topic("/rosout")
    origins = [Origin.of(bytes(endpoint.endpoint_gid)) for endpoint in endpoints]
    assert None not in origins
    assert participants_listening(node.context.get_domain_id())


def test_where_the_kernel_does_not_tell_ports_none_are_counted():
    assert participants_listening(3, lambda: "header\nwhat is this") is None


@pytest.mark.parametrize("size", [0, 3, 20, 40])
def test_an_announcement_of_another_form_is_refused(size):
    with pytest.raises(NotAsExpected, match="announces nodes in another form"):
        entities(b"\0\1\0\0" + b"\xff" * size if size > 3 else bytes(size))


@pytest.mark.parametrize("structure", ["_QosProfile", "_MessageInfo", "_SerializedMessage"])
def test_a_structure_with_one_field_more_is_found_and_not_relied_on(structure):
    code = f"""
with_one_field_more({structure!r})
try:
    open_and_take()
except NotAsExpected as error:
    print(error)
"""
    assert child(code).stdout.endswith(" here\n")


def test_beside_a_rmw_of_another_series_lists_of_nodes_wait_and_one_line_says_why(tmp_path: Path):
    told = tmp_path / "share/rmw/package.xml"
    told.parent.mkdir(parents=True)
    told.write_text('<package format="2">\n  <version>7.4.0</version>\n</package>')
    code = f"""
os.environ["AMENT_PREFIX_PATH"] = {str(tmp_path)!r} + os.pathsep + os.environ["AMENT_PREFIX_PATH"]
from course_kit.ros.graph import graph
other = Node("other")
print(discovery.of(node).wait(0.5), sorted(name.full_name for name in graph.nodes(node)))
discovery.forget(node)
"""
    done = child(code)
    assert done.stdout == "False ['/other', '/sentry']\n"
    assert done.stderr.splitlines() == [
        "course_kit: rmw 7.4.0 is here, the C structures known are those of 7.3.x: lists of nodes and topics take some "
        "seconds, and may miss what is slow to appear"
    ]


def test_where_what_comes_is_another_structure_nodes_are_listed_all_the_same():
    code = """
with_one_field_more("_MessageInfo")
from course_kit.ros.graph import graph
print(discovery.of(node).wait(0.5), [name.full_name for name in graph.nodes(node)])
discovery.forget(node)
"""
    done = child(code)
    assert done.stdout == "False ['/sentry']\n"
    assert "rmw_fastrtps_cpp has another rmw_message_info_t here: lists of nodes" in done.stderr


def test_beside_a_rmw_of_another_series_log_lines_go_by_the_name_of_the_node():
    code = """
rmw_parts.SERIES["rmw"] = "7.4."
from course_kit.ros.observing.domain_observer import DomainObserver
from tests.waiting import wait_until
observer = DomainObserver(None, only_here=False)
log = observer.node_log()
node.get_logger().info("here I am")
wait_until(lambda: log.lines("sentry"))
print([message.msg for message in log.said_by([], "sentry")])
observer.close()
"""
    assert child(code).stdout == "['here I am']\n"


def test_a_function_that_is_not_there_is_named():
    with pytest.raises(NotAsExpected, match=r"librmw\.so has no rmw_of_tomorrow here"):
        rmw_parts._function("librmw.so", "rmw_of_tomorrow", None)
