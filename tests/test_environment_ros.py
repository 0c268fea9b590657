"""Checks of ROS 2, with real nodes where it matters."""

from __future__ import annotations

import os
import sys
import time

import pytest

from course_kit.setup.environment import check_environment, user_domain
from course_kit.setup.environment.activation import RosInstallation
from course_kit.setup.environment.checks import ros
from course_kit.setup.environment.checks.ros import RoundTrip
from course_kit.setup.environment.interpreter import Interpreter

APT = RosInstallation("/opt/ros/jazzy", "jazzy")
HUMBLE = RosInstallation("/opt/ros/humble", "humble")


def some_python(**facts) -> Interpreter:
    return Interpreter("/course/.venv/bin/python", (3, 12, 3), "/course/.venv", True, True, **facts)


@pytest.fixture
def unused(monkeypatch, tmp_path) -> None:
    """No user has ports in shared memory, where those of other tests are."""
    monkeypatch.setattr(user_domain, "SHARED_MEMORY", str(tmp_path))


@pytest.mark.usefixtures("unused")
@pytest.mark.parametrize(
    ("value", "status"),
    [
        ("0", "PASS"), ("101", "PASS"), ("102", "WARN"), ("232", "WARN"), ("233", "FAIL"), ("-1", "FAIL"),
        ("4294967295", "FAIL"), ("seven", "FAIL"), ("1.5", "FAIL"), ("²", "FAIL"),
    ],
)  # fmt: skip
def test_domains_are_0_to_232_and_best_up_to_101(value, status):
    check = ros.domain({"ROS_DOMAIN_ID": value}, uid=1000)
    assert check.status == status
    assert status == "PASS" or check.cure == "export ROS_DOMAIN_ID=1"


@pytest.mark.usefixtures("unused")
def test_without_a_domain_the_course_takes_one_for_the_user():
    check = ros.domain({}, uid=1041)
    assert (check.status, "uses 42" in check.detail) == ("PASS", True)


@pytest.mark.parametrize(
    ("variables", "status"),
    [
        ({}, "PASS"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, "PASS"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, "WARN"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT"}, "WARN"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "localhost"}, "WARN"),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, "FAIL"),
        ({"ROS_LOCALHOST_ONLY": "1"}, "PASS"),
        ({"ROS_LOCALHOST_ONLY": "0"}, "WARN"),
        ({"ROS_STATIC_PEERS": "10.0.0.7"}, "WARN"),
        ({"ROS_STATIC_PEERS": "10.0.0.7", "ROS_LOCALHOST_ONLY": "1"}, "WARN"),
    ],
)
def test_nodes_should_stay_on_this_machine_and_find_each_other(variables, status):
    assert ros.discovery(variables).status == status


def test_a_middleware_that_is_not_installed_fails(tmp_path):
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib/librmw_fastrtps_cpp.so").touch()

    def check(value: str):
        return ros.middleware({"RMW_IMPLEMENTATION": value}, None, str(tmp_path), ready=True)

    assert check("rmw_fastrtps_cpp").status == "PASS"
    assert (check("rmw_cyclonedds_cpp").status, check("rmw_cyclonedds_cpp").cure) == (
        "FAIL",
        "unset RMW_IMPLEMENTATION",
    )


def test_before_set_up_the_middleware_of_the_wheels_is_expected_and_no_other(tmp_path):
    def status(value: str) -> str:
        return ros.middleware({"RMW_IMPLEMENTATION": value}, None, str(tmp_path), ready=False).status

    assert [status("rmw_fastrtps_cpp"), status("rmw_cyclonedds_cpp")] == ["PASS", "FAIL"]


def test_a_middleware_of_apt_is_cured_with_apt():
    check = ros.middleware({"RMW_IMPLEMENTATION": "rmw_zenoh_cpp"}, APT, "/course/.venv", ready=True)
    assert check.cure == "sudo apt-get install -y ros-jazzy-rmw-zenoh-cpp"


def test_another_distribution_warns_and_names_where_it_is_sourced():
    check = ros.other_installations([HUMBLE], {"ROS_DISTRO": "humble"})
    assert check.status == "WARN"
    assert "/opt/ros/humble/setup.bash" in check.cure
    # In a kernel the course has already taken its folders out of the environment.
    assert ros.other_installations([], {"ROS_DISTRO": "humble"}).status == "WARN"


def test_two_installations_at_once_fail():
    other = RosInstallation("/home/student/ros2_jazzy/install", "jazzy")
    assert ros.other_installations([APT, other], {"ROS_DISTRO": "jazzy"}).status == "FAIL"


def test_one_sourced_jazzy_and_none_pass():
    assert ros.other_installations([APT], {"ROS_DISTRO": "jazzy"}).detail == "jazzy from /opt/ros/jazzy"
    assert ros.other_installations([], {}).status == "PASS"


def test_rclpy_must_come_from_the_installation_that_the_course_uses():
    wheels = some_python(
        rclpy="/course/.venv/lib/python3.12/site-packages/rclpy", distributions={"ros-jazzy-rclpy": "7.1.6"}
    )
    apt = some_python(rclpy="/opt/ros/jazzy/lib/python3.12/site-packages/rclpy")
    assert "wheels" in ros.installation(None, wheels, ready=True).detail
    assert ros.installation(APT, apt, ready=True).detail == "Jazzy from /opt/ros/jazzy"
    for installation, python in ((None, apt), (APT, wheels), (None, some_python()), (APT, some_python())):
        assert ros.installation(installation, python, ready=True).status == "FAIL"


def test_before_set_up_ros_is_announced_and_not_a_failure():
    assert ros.installation(None, some_python(), ready=False).status == "WARN"
    assert ros.installation(APT, some_python(), ready=False).status == "PASS"


# ---- real nodes


def test_a_message_gets_from_one_process_to_another():
    result = ros.round_trip(sys.executable, os.environ)
    assert result.error == ""
    assert result.rmw.startswith("rmw_")
    assert result.message is not None
    assert ros.node(result).status == "PASS"


def test_nodes_that_cannot_find_each_other_are_noticed():
    result = ros.round_trip(sys.executable, os.environ | {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, message_timeout=2)
    assert (result.error, result.message) == ("", None)
    assert ros.node(result).status == "FAIL"


def test_rclpy_that_cannot_start_is_reported_in_its_own_words():
    result = ros.round_trip(sys.executable, os.environ | {"RMW_IMPLEMENTATION": "rmw_missing_cpp"})
    assert "rmw_missing_cpp" in result.error
    assert ros.node(result).status == "FAIL"


def test_a_python_that_hangs_is_ended(tmp_path):
    hanging = tmp_path / "python"
    hanging.write_text("#!/bin/sh\nsleep 60\n")
    hanging.chmod(0o755)
    begun = time.monotonic()
    assert ros.round_trip(str(hanging), os.environ, timeout=0.5).error == "no answer from rclpy in 0.5 s"
    assert time.monotonic() - begun < 10


def test_a_failed_round_trip_says_what_went_wrong():
    assert ros.node(RoundTrip(error="no such library")).detail == "no such library"


def test_a_notebook_shows_that_its_environment_works():
    report = check_environment()
    assert report.failed == []
    assert "message after" in repr(report)
    assert "check itself failed" not in repr(report)
