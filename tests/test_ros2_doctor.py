"""`ros2 doctor`: what the checks make of data, the report's text, and a real QoS mismatch between two processes."""

from __future__ import annotations

import dataclasses
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace

import psutil  # type: ignore[import-untyped]
import pytest

from course_kit.cli.ros2.doctor import checks, doctor, report
from course_kit.cli.ros2.doctor.checks import Pair, System, Topic
from course_kit.ros import packages
from tests.ros2_command import ros2
from tests.senders import Sender

pytestmark = pytest.mark.usefixtures("fresh_domain")

LOOPBACK = {"device": "lo", "flags": "UP,LOOPBACK,RUNNING"}
ETHERNET = {"device": "eth0", "flags": "UP,BROADCAST,RUNNING,MULTICAST"}
MISFIT = "ERROR: Best effort publisher and reliable subscription;"
HEALTHY = System(
    interfaces=[LOOPBACK, ETHERNET],
    packages={"rclpy": "7.1.5", "std_msgs": "5.3.6"},
    distro="jazzy",
    middleware="rmw_fastrtps_cpp",
    topics=[Topic("/chatter", 2, 1)],
    pairs=[Pair("/chatter", "std_msgs/msg/String", "talker", "listener")],
)
LISTENER = """
import sys
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("listener")
node.create_subscription(String, sys.argv[1], lambda message: None, 10)
print("ready", flush=True)
sys.stdin.readline()
node.destroy_node()
rclpy.shutdown()
"""


def system(**changes: object) -> System:
    return dataclasses.replace(HEALTHY, **changes)  # type: ignore[arg-type]


def findings(system: System) -> dict[str, list[str]]:
    found = {name: list(check(system)) for name, check in checks.CHECKS.items()}
    return {name: lines for name, lines in found.items() if lines}


def test_nothing_is_found_where_all_is_well():
    assert findings(HEALTHY) == {}
    assert checks.summary(5, []) == "\nAll 5 checks passed\n"


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        (
            {"interfaces": [LOOPBACK]},
            {"network": ["Only loopback IP address is found.", "No multicast IP address is found."]},
        ),
        ({"interfaces": [ETHERNET]}, {"network": ["ERROR: No loopback IP address is found."]}),
        ({"packages": {}}, {"package": ["ERROR: local package info is not found."]}),
        (
            {"packages": {"lab": ""}},
            {"package": ["Cannot find local versions of packages: lab. Use `ros2 doctor --report` to see full list."]},
        ),
        ({"distro": ""}, {"platform": ["ERROR: ROS_DISTRO is not set."]}),
        ({"distro": "jazy"}, {"platform": ["ERROR: Distribution name jazy is not found"]}),
        ({"topics": [Topic("/a", 1, 0)]}, {"topic": ["Publisher without subscriber detected on /a."]}),
        ({"topics": [Topic("/a", 0, 2)]}, {"topic": ["Subscriber without publisher detected on /a."]}),
        (
            {"pairs": [Pair("/a", "t", "p", "s", MISFIT)]},
            {
                "middleware": [
                    "ERROR: QoS compatibility error found on topic '/a': "
                    "Best effort publisher and reliable subscription;"
                ]
            },
        ),
        (
            {"pairs": [Pair("/a", "t", "p", "s", "WARNING: Publisher liveliness is system_default;")]},
            {"middleware": ["QoS compatibility warning found on topic '/a': Publisher liveliness is system_default;"]},
        ),
    ],
)
def test_what_is_wrong_is_found_in_its_module(changes, found):
    assert findings(system(**changes)) == found


def test_warnings_fail_a_check_only_when_they_are_included():
    found = {name: list(check(system(topics=[Topic("/a", 1, 0)]))) for name, check in checks.CHECKS.items()}
    assert checks.failed(found, include_warnings=False) == []
    assert checks.failed(found, include_warnings=True) == ["topic"]
    assert checks.summary(5, ["topic"]) == "\n1/5 check(s) failed\n\nFailed modules: topic"


def text_of(system: System, *modules: str) -> str:
    return "\n".join(map(str, report.sections(system, modules)))


def address(family: int, address: str, netmask: str | None = None, broadcast: str | None = None) -> SimpleNamespace:
    return SimpleNamespace(family=family, address=address, netmask=netmask, broadcast=broadcast)


def test_the_report_of_the_network(monkeypatch):
    loopback = [
        address(socket.AF_INET, "127.0.0.1", "255.0.0.0"),
        address(socket.AF_INET6, "::1"),
        address(psutil.AF_LINK, "00:00:00:00:00:00"),
    ]
    ethernet = [
        address(socket.AF_INET, "10.0.0.2", "255.0.0.0", "10.255.255.255"),
        address(psutil.AF_LINK, "02:fc:00:00:00:01", broadcast="ff:ff:ff:ff:ff:ff"),
    ]
    stats = {
        "lo": SimpleNamespace(flags="up,loopback,running", mtu=65536),
        "eth0": SimpleNamespace(flags="up,broadcast,running,multicast", mtu=1500),
    }
    monkeypatch.setattr(psutil, "net_if_addrs", lambda: {"lo": loopback, "eth0": ethernet})
    monkeypatch.setattr(psutil, "net_if_stats", lambda: stats)
    assert text_of(system(interfaces=list(doctor.interfaces())), "network") == (
        "\n   NETWORK CONFIGURATION\n"
        "inet         : 127.0.0.1\n"
        "inet4        : ['127.0.0.1']\n"
        "inet6        : ['::1']\n"
        "netmask      : 255.0.0.0\n"
        "device       : lo\n"
        "flags        : UP,LOOPBACK,RUNNING\n"
        "mtu          : 65536\n"
        "inet         : 10.0.0.2\n"
        "inet4        : ['10.0.0.2']\n"
        "ether        : 02:fc:00:00:00:01\n"
        "netmask      : 255.0.0.0\n"
        "device       : eth0\n"
        "flags        : UP,BROADCAST,RUNNING,MULTICAST\n"
        "mtu          : 1500\n"
        "broadcast    : 10.255.255.255"
    )


def test_the_report_of_the_graph():
    pairs = [*HEALTHY.pairs, Pair("/scan", "sensor_msgs/msg/LaserScan", "lidar", "mapper", MISFIT)]
    assert text_of(system(pairs=pairs), "middleware", "topic") == (
        "\n   QOS COMPATIBILITY LIST\n"
        "topic [type]            : /chatter [std_msgs/msg/String]\n"
        "publisher node          : talker\n"
        "subscriber node         : listener\n"
        "compatibility status    : OK\n"
        "topic [type]            : /scan [sensor_msgs/msg/LaserScan]\n"
        "publisher node          : lidar\n"
        "subscriber node         : mapper\n"
        f"compatibility status    : {MISFIT}\n"
        "\n   RMW MIDDLEWARE\n"
        "middleware name    : rmw_fastrtps_cpp\n"
        "\n   TOPIC LIST\n"
        "topic               : /chatter\n"
        "publisher count     : 2\n"
        "subscriber count    : 1"
    )


def test_the_report_of_an_empty_graph():
    text = text_of(system(topics=[], pairs=[]), "middleware", "topic")
    assert "compatibility status    : No publisher/subscriber pairs found\n" in text
    assert text.endswith("topic               : none\npublisher count     : 0\nsubscriber count    : 0")


def test_the_report_of_the_platform_and_the_packages():
    text = text_of(HEALTHY, "package", "platform")
    assert "\n   PACKAGE VERSIONS\nrclpy       : latest=N/A, local=7.1.5\nstd_msgs    : latest=N/A, " in text
    assert "\n   PLATFORM INFORMATION\nsystem           : Linux\nplatform info    : Linux-" in text
    assert text.endswith(
        "\n   ROS 2 INFORMATION\n"
        "distribution name      : jazzy\n"
        "distribution type      : ros2\n"
        "distribution status    : active\n"
        "release platforms      : {'debian': ['bookworm'], 'rhel': ['9'], 'ubuntu': ['noble']}"
    )
    assert text_of(system(distro="jazy"), "platform").endswith("distribution name    : jazy")


@contextmanager
def listener(topic: str) -> Iterator[None]:
    """A process with a reliable subscription."""
    arguments = [sys.executable, "-c", LISTENER, topic]
    with subprocess.Popen(arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        try:
            yield
        finally:
            process.communicate(timeout=20)


def test_a_quiet_system_passes_all_checks():
    done = ros2("doctor")
    assert (done.out, done.status) == ("\nAll 5 checks passed\n\n", 0)
    assert not [line for line in done.err.splitlines() if "IP address" not in line]
    assert ros2("wtf", "--exclude-packages").out == "\nAll 4 checks passed\n\n"


def test_a_qos_mismatch_of_two_processes_fails_a_check():
    misfit = "UserWarning: ERROR: QoS compatibility error found on topic '/mismatch': Best effort publisher and "
    with Sender("/mismatch", qos="best_effort"), Sender("/lonely"), listener("/mismatch"):
        done = ros2("doctor")
        failed = ros2("doctor", "-rf")
        strict = ros2("doctor", "--include-warnings", "-ep")
    assert (done.out, done.status) == ("\n1/5 check(s) failed\n\nFailed modules: middleware\n", 0)
    lines = [line for line in done.err.splitlines() if "IP address" not in line]
    assert lines == [
        f"{misfit}reliable subscription;",
        "UserWarning: Publisher without subscriber detected on /lonely.",
    ]
    assert failed.out.startswith(done.out)
    assert [line.strip() for line in failed.out.splitlines() if line.startswith("   ")] == [
        "QOS COMPATIBILITY LIST",
        "RMW MIDDLEWARE",
    ]
    assert (
        "topic [type]            : /mismatch [std_msgs/msg/String]\n"
        "publisher node          : sender_of_string\n"
        "subscriber node         : listener\n"
        f"compatibility status    : {MISFIT}\n"
    ) in failed.out
    assert "/4 check(s) failed\n\nFailed modules: " in strict.out
    assert strict.out.endswith("middleware topic\n")


def test_the_report_of_a_running_system_is_whole():
    with Sender("/scan", "scan", qos="best_effort"), Sender("/chatter"), listener("/chatter"):
        done = ros2("doctor", "--report")
    assert (done.err, done.status) == ("", 0)
    sections = [section.split("\n", 1) for section in done.out.split("\n   ")[1:]]
    texts = {title: text for title, text in sections}
    assert [title for title, _ in sections] == [
        "NETWORK CONFIGURATION",
        "PACKAGE VERSIONS",
        "PLATFORM INFORMATION",
        "QOS COMPATIBILITY LIST",
        "RMW MIDDLEWARE",
        "ROS 2 INFORMATION",
        "TOPIC LIST",
    ]
    assert "device       : lo\n" in texts["NETWORK CONFIGURATION"]
    versions = [line.split(":")[0].strip() for line in texts["PACKAGE VERSIONS"].splitlines() if "latest=" in line]
    assert versions == packages.package_names()
    assert texts["QOS COMPATIBILITY LIST"] == (
        "topic [type]            : /chatter [std_msgs/msg/String]\n"
        "publisher node          : sender_of_string\n"
        "subscriber node         : listener\n"
        "compatibility status    : OK\n"
    )
    assert texts["RMW MIDDLEWARE"] == "middleware name    : rmw_fastrtps_cpp\n"
    assert texts["TOPIC LIST"] == (
        "topic               : /chatter\npublisher count     : 1\nsubscriber count    : 1\n"
        "topic               : /scan\npublisher count     : 1\nsubscriber count    : 0\n"
    )


def test_an_unknown_distribution_fails_the_platform_check():
    done = ros2("doctor", ROS_DISTRO="jazy")
    assert done.out.endswith("Failed modules: platform\n")
    assert "UserWarning: ERROR: Distribution name jazy is not found\n" in done.err


def test_report_and_report_failed_exclude_each_other():
    done = ros2("doctor", "-r", "-rf")
    assert (done.out, done.status) == ("", 2)
    assert done.err.endswith("error: argument --report-failed/-rf: not allowed with argument --report/-r\n")
