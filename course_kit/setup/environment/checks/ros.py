"""Checks of ROS 2: which one is used, whether a message gets through, domain, discovery, middleware."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from course_kit.setup.environment import user_domain
from course_kit.setup.environment.activation import DISTRO, RosInstallation, sourced_ros, split_paths
from course_kit.setup.environment.checks.python import NOT_SET_UP, RENEW
from course_kit.setup.environment.interpreter import Interpreter, ask
from course_kit.setup.environment.report import Check, fail, passed, warn

MESSAGE_TIMEOUT = 10.0  # discovery after peers that died takes up to 3 s
PROCESS_TIMEOUT = 30.0
LARGEST_DOMAIN = 232  # above it the port numbers of DDS end
LARGEST_SAFE_DOMAIN = 101  # above it DDS's ports are those that Linux gives to any program
UNSOURCE = (
    "env -u AMENT_PREFIX_PATH -u CMAKE_PREFIX_PATH -u LD_LIBRARY_PATH -u PYTHONPATH -u ROS_DISTRO "
    "./environment-check.sh lab, and for good: take `source {}/setup.bash` out of ~/.bashrc"
)


def installation(ros: RosInstallation | None, python: Interpreter, ready: bool) -> Check:
    """The ROS 2 that the notebooks will use: a sourced Jazzy, else the wheels in the environment."""
    if not ready:
        return passed(f"Jazzy from {ros.prefix}, and the course will use it") if ros else NOT_SET_UP
    if ros is None:
        version = python.distributions.get("ros-jazzy-rclpy", "")
        if version and Path(python.rclpy).is_relative_to(python.prefix):
            return passed(f"Jazzy from the wheels in the environment: rclpy {version}")
    elif python.rclpy and Path(python.rclpy).is_relative_to(ros.prefix):
        return passed(f"Jazzy from {ros.prefix}")
    found = f"rclpy comes from {python.rclpy}" if python.rclpy else f"no rclpy for {python.path}"
    reason = f"it should come from {ros.prefix if ros else python.prefix}; else it is another or half a ROS 2"
    return fail(found, reason, RENEW)


def other_installations(installations: Sequence[RosInstallation], environ: Mapping[str, str]) -> Check:
    """A sourced ROS of another distribution, or two at once."""
    distro = environ.get("ROS_DISTRO", "")
    prefixes = [ros.prefix for ros in installations]
    foreign = [ros for ros in installations if ros.distro != DISTRO]
    if foreign or (distro not in ("", DISTRO) and not installations):
        where = foreign[0].prefix if foreign else f"/opt/ros/{distro}"
        detail = f"{distro or foreign[0].distro} is sourced ({where}), the course is for {DISTRO}"
        reason = "the course takes it out of its own processes; others of this terminal would mix the two"
        return warn(detail, reason, UNSOURCE.format(where))
    if len(prefixes) > 1:
        reason = "libraries of two installations in one process end in crashes that look like bugs of yours"
        return fail(f"several are sourced: {' '.join(prefixes)}", reason, UNSOURCE.format(prefixes[-1]))
    return passed(f"{DISTRO} from {prefixes[0]}" if prefixes else "none, the course brings its own")


@dataclass(frozen=True)
class RoundTrip:
    """Seconds that a node and a message took; `message` is None if none came, `error` what went wrong."""

    rmw: str = ""
    node: float = 0.0
    message: float | None = None
    error: str = ""


def round_trip(
    python: str, environ: Mapping[str, str], message_timeout: float = MESSAGE_TIMEOUT, timeout: float = PROCESS_TIMEOUT
) -> RoundTrip:
    """Really start two nodes with that Python and send one message; timeouts in seconds."""
    try:
        return RoundTrip(**ask(python, environ, "round_trip", str(message_timeout), timeout))
    except subprocess.TimeoutExpired:
        return RoundTrip(error=f"no answer from rclpy in {timeout:g} s")
    except ValueError as error:
        return RoundTrip(error=str(error))


def node(result: RoundTrip) -> Check:
    """Return True if a node starts and a message gets from one process to another."""
    if result.error:
        reason = "rclpy does not start a node; the lines ROS 2, RMW_IMPLEMENTATION and PYTHONPATH may say more"
        return fail(result.error, reason, RENEW)
    if result.message is None:
        reason = "something keeps DDS from the loopback network or from shared memory"
        cure = "unset ROS_AUTOMATIC_DISCOVERY_RANGE ROS_DISCOVERY_SERVER FASTRTPS_DEFAULT_PROFILES_FILE"
        return fail("a node starts, but no message came from another process", reason, cure)
    return passed(f"started in {result.node:.2f} s, message after {result.message:.2f} s ({result.rmw})")


def domain(environ: Mapping[str, str], uid: int) -> Check:
    """ROS_DOMAIN_ID: a number from 0 to 232, best up to 101."""
    value = environ.get("ROS_DOMAIN_ID", "")
    if not value:
        return passed(f"not set: the course uses {user_domain.take(uid)}, a domain of your own")
    cure = f"export ROS_DOMAIN_ID={user_domain.take(uid)}"
    if not value.isascii() or not value.isdigit() or int(value) > LARGEST_DOMAIN:
        return fail(value, f"ROS 2 has the domains 0 to {LARGEST_DOMAIN} and no others", cure)
    if int(value) > LARGEST_SAFE_DOMAIN:
        reason = f"above {LARGEST_SAFE_DOMAIN} any other program may already have the ports that DDS needs"
        return warn(value, reason, cure)
    return passed(value)


def discovery(environ: Mapping[str, str]) -> Check:
    """Which machines the nodes look for others on."""
    only_here = environ.get("ROS_LOCALHOST_ONLY", "")
    value = environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "")
    if environ.get("ROS_STATIC_PEERS") and (only_here == "1" or (value in ("", "LOCALHOST") and only_here != "0")):
        reason = "nodes listen on this machine only, so the peers are neither heard nor reached"
        cure = "unset ROS_STATIC_PEERS, or export ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET"
        return warn(f"LOCALHOST, but ROS_STATIC_PEERS={environ['ROS_STATIC_PEERS']}", reason, cure)
    if only_here == "1":
        return passed("this machine only (ROS_LOCALHOST_ONLY=1)")
    if not value and "ROS_LOCALHOST_ONLY" not in environ:
        return passed("not set: the course stays on this machine (LOCALHOST)")
    cure = "export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"
    if value == "LOCALHOST":
        return passed(value)
    if value == "OFF":
        return fail(value, "nodes find no other process, so neither the turtle nor the checks of the exercises", cure)
    if value in ("SUBNET", "SYSTEM_DEFAULT", ""):
        reason = "your nodes and those of everybody in this network with your domain drive each other's robots"
        return warn(value or "ROS_LOCALHOST_ONLY=0", reason, f"unset ROS_LOCALHOST_ONLY; {cure}")
    reason = "ROS 2 knows LOCALHOST, SUBNET, OFF and SYSTEM_DEFAULT, and warns at every start about others"
    return warn(value, reason, cure)


def middleware(environ: Mapping[str, str], ros: RosInstallation | None, prefix: str, ready: bool) -> Check:
    """RMW_IMPLEMENTATION names a middleware that is installed."""
    value = environ.get("RMW_IMPLEMENTATION", "")
    if not value:
        return passed("not set: ROS 2 takes its default, Fast DDS")
    folders = [os.path.join(ros.prefix if ros else prefix, "lib")]
    if ros is not None:  # an overlay may bring one; the course's own environment has none but its own
        folders += split_paths(environ.get("LD_LIBRARY_PATH", ""))
    there = any(Path(folder, f"lib{value}.so").exists() for folder in folders)
    if there or (not ready and ros is None and value == "rmw_fastrtps_cpp"):
        return passed(value)
    reason = "rclpy loads the middleware of that name when it starts, and ends if it is not there"
    install = f"sudo apt-get install -y ros-{DISTRO}-{value.replace('_', '-')}"
    return fail(f"{value} is not installed", reason, install if ros else "unset RMW_IMPLEMENTATION")


if __name__ == "__main__":  # environment-check.sh asks for the ROS 2 that it has to leave out of the packages
    found = sourced_ros(os.environ)
    sys.stdout.write(f"{found.prefix}\n" if found else "")
