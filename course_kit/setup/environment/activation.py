"""Gives every Python of the course's environment what sourcing a ROS 2 set-up file would give it.

A .pth file calls activate() whenever that Python starts: in kernels, terminals, child processes and tests.
What the user set is kept. Quick, for it is part of every start: no module is imported that Python has not loaded then.
"""

from __future__ import annotations

import os
import sys

from course_kit.setup.environment import user_domain

TYPE_CHECKING = False  # type checkers take it for True
if TYPE_CHECKING:
    from collections.abc import Mapping, MutableMapping

DISTRO = "jazzy"
PROFILE = os.path.join(os.path.dirname(__file__), "fastdds_profile.xml")
PATH_VARIABLES = ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PATH", "PYTHONPATH")
# Corrects what the CMake files of the wheels say about the machine that built them.
TOOLCHAIN = "share/course_kit/cmake/toolchain.cmake"
RANGES = ("LOCALHOST", "SUBNET", "OFF", "SYSTEM_DEFAULT")
PROFILE_VARIABLES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
DOMAIN_OF_USER = "COURSE_KIT_DOMAIN"  # the ROS_DOMAIN_ID that the user did not set
# Set by the ROS wheels when they restarted Python with their libraries on LD_LIBRARY_PATH.
RESTARTED = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
LOCKS = "COURSE_KIT_LOCKS"  # those of the user's domain, over that restart


def has_package(prefix: str, name: str) -> bool:
    """Return True if a ROS package is installed there."""
    return os.path.exists(os.path.join(prefix, "share/ament_index/resource_index/packages", name))


class RosInstallation:
    """A ROS 2 that the user sourced, as apt installs it to /opt/ros."""

    def __init__(self, prefix: str, distro: str) -> None:
        self.prefix = prefix
        self.distro = distro


def split_paths(value: str) -> list[str]:
    """The entries of a PATH-like variable, without the empty ones."""
    return [entry for entry in value.split(os.pathsep) if entry]


def installations(environ: Mapping[str, str]) -> list[RosInstallation]:
    """Every ROS 2 with rclpy on AMENT_PREFIX_PATH that is not a Python environment like ours."""
    prefixes = [os.path.normpath(entry) for entry in split_paths(environ.get("AMENT_PREFIX_PATH", ""))]
    found = [p for p in prefixes if has_package(p, "rclpy") and not os.path.exists(os.path.join(p, "pyvenv.cfg"))]
    return [RosInstallation(p, environ.get("ROS_DISTRO", os.path.basename(p))) for p in found]


def sourced_ros(environ: Mapping[str, str]) -> RosInstallation | None:
    """The sourced ROS 2 Jazzy, or None. The course uses it instead of the wheels."""
    return next((ros for ros in installations(environ) if ros.distro == DISTRO), None)


def _has_command(name: str, environ: Mapping[str, str]) -> bool:
    """shutil.which() without importing shutil, which takes a tenth of Python's start."""
    return any(os.access(os.path.join(entry, name), os.X_OK) for entry in split_paths(environ.get("PATH", "")))


def _put_last(prefix: str, name: str, environ: MutableMapping[str, str]) -> None:
    others = [entry for entry in split_paths(environ.get(name, "")) if entry != prefix]
    environ[name] = os.pathsep.join([*others, prefix])


def activate(prefix: str = sys.prefix, environ: MutableMapping[str, str] = os.environ) -> None:
    """Complete the environment of this process for ROS 2."""
    if has_package(prefix, "rclpy"):
        _leave_installations(environ)
        # Last: a colcon workspace that the user sourced lies over ROS 2, as it lies over /opt/ros.
        for name in ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
            _put_last(prefix, name, environ)
        environ.setdefault("CMAKE_TOOLCHAIN_FILE", os.path.join(prefix, TOOLCHAIN))
        if not _has_command("make", environ):
            environ.setdefault("CMAKE_GENERATOR", "Ninja")  # the wheel `ninja` is installed too
        # A process started from another Python environment with ROS wheels has only that one's libraries.
        if os.path.join(prefix, "lib") not in split_paths(environ.get("LD_LIBRARY_PATH", "")):
            environ.pop(RESTARTED, None)
    elif has_package(prefix, "course_robot"):  # beside a sourced ROS 2: the packages that it does not bring
        _put_last(prefix, "AMENT_PREFIX_PATH", environ)
    environ["COURSE_KIT_PREFIX"] = prefix
    bin_folder = os.path.join(prefix, "bin")
    others = [entry for entry in split_paths(environ.get("PATH", "")) if entry != bin_folder]
    environ["PATH"] = os.pathsep.join([bin_folder, *others])
    if " " in prefix:
        _allow_spaces(prefix, environ)
    # The older variable counts where it is set; the profile reads the newer one.
    is_open = (environ.get("ROS_LOCALHOST_ONLY") or "1") != "1"
    reach = environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or ("SUBNET" if is_open else "LOCALHOST")
    environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = reach
    # One that was given out before, to a parent of this process, is held by this one too.
    domain, given = environ.get("ROS_DOMAIN_ID"), environ.get(DOMAIN_OF_USER)
    held = user_domain.take(os.getuid(), given)
    if domain == given:
        environ["ROS_DOMAIN_ID"] = environ[DOMAIN_OF_USER] = held
    # Also in a domain that the user has set: another user may have set the same.
    environ.update(user_domain.ports_of(held))
    if LOCKS in environ:
        user_domain.after_restart(environ.pop(LOCKS))
    if RESTARTED not in environ and has_package(prefix, "rclpy"):
        environ[LOCKS] = user_domain.hold_over_restart()
    # Without the check, which ROS 2 leaves out by default, an int in a float field arrives as garbage.
    environ.setdefault("ROS_PYTHON_CHECK_FIELDS", "1")
    own_profile = os.path.exists("DEFAULT_FASTRTPS_PROFILES.xml")
    # A range that there is not is left to ROS, which warns of it: the profile has a transport for each that there is.
    if reach in RANGES and not own_profile and not any(environ.get(name) for name in PROFILE_VARIABLES):
        environ[PROFILE_VARIABLES[0]] = PROFILE


def _allow_spaces(prefix: str, environ: MutableMapping[str, str]) -> None:
    """Let colcon build and its setup files work although there is a space in the environment's own path."""
    # The setup files do not quote the Python that runs them; any does.
    environ.setdefault("COLCON_PYTHON_EXECUTABLE", os.path.realpath(os.path.join(prefix, "bin/python")))
    # A script's first line cannot name such a Python; this setting for setuptools has it found on PATH.
    environ.setdefault("DIST_EXTRA_CONFIG", os.path.join(prefix, "share/course_kit/scripts.cfg"))


def _leave_installations(environ: MutableMapping[str, str]) -> None:
    """Take sourced ROS 2 installations out of the environment: their libraries and the wheels' do not mix."""
    prefixes = [ros.prefix + os.sep for ros in installations(environ)]
    for name in PATH_VARIABLES if prefixes else ():
        entries = split_paths(environ.get(name, ""))
        kept = [e for e in entries if not (e + os.sep).startswith(tuple(prefixes))]
        if kept != entries:
            environ[name] = os.pathsep.join(kept)
            environ.pop(RESTARTED, None)
