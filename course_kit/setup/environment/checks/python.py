"""Checks of Python: its version, the environment made with it, what gets in its way, the compiler."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from course_kit.setup.environment import stamp
from course_kit.setup.environment.activation import RosInstallation, split_paths
from course_kit.setup.environment.compiler import WHEEL as ZIG
from course_kit.setup.environment.compiler import of_the_machine
from course_kit.setup.environment.interpreter import (
    NEWEST,
    OLDEST,
    SET_UP,
    Interpreter,
    another_python,
    apt_package,
    interfaces_to_compile,
    supported,
)
from course_kit.setup.environment.report import Check, fail, passed, warn

RENEW = f"rm -rf .venv && {SET_UP}"
NOT_SET_UP = warn("not set up yet", "it comes with the environment of the course", SET_UP)
# Packages that the course brings; another copy on PYTHONPATH would be loaded instead of it.
OURS = ("rclpy", "rosidl_runtime_py", "turtlesim", "example_interfaces", "std_msgs", "numpy", "matplotlib")
ROS_PACKAGES = ("rclpy", "std_msgs", "example_interfaces", "turtlesim")

STATES = {
    stamp.MISSING: "not set up yet",
    stamp.UNFINISHED: "a set-up was interrupted, or still runs",
    stamp.OUTDATED: "set up for another version of the course, another Python, ROS 2 or folder",
    stamp.INCOMPLETE: "not made by this script, and the course is not in it",
}


def shown(path: str) -> str:
    """A path as the report shows it: from the course's folder on, if it is inside."""
    return path.removeprefix(f"{stamp.ROOT}{os.sep}")


def version(python: Interpreter, ros: RosInstallation | None, environ: Mapping[str, str]) -> Check:
    """Python 3.10 to 3.14, and with a sourced ROS 2 the one that ROS 2 is built for."""
    detail = f"{'.'.join(map(str, python.version))} ({shown(python.path)})"
    if supported(python.version, ros):
        return passed(detail)
    reason = "the wheels of ROS 2 exist for Python {}.{} to {}.{}".format(*OLDEST, *NEWEST)
    if ros is not None:
        reason = f"the ROS 2 in {ros.prefix} is compiled for another Python, and rclpy loads in that one only"
    return fail(detail, reason, another_python(ros, environ))


def set_up(state: str, python: Interpreter) -> Check:
    """The environment in .venv: there, finished and of this version of the course."""
    if state in stamp.USABLE:
        if not python.unmet:
            return passed(f"{shown(python.prefix)} with {len(python.distributions)} packages")
        listed = ", ".join(python.unmet[:3]) + (" ..." if len(python.unmet) > 3 else "")
        found = f"{len(python.unmet)} packages are missing or have another version than the course's: {listed}"
        return warn(found, "the course is tested with exactly its pinned versions", RENEW)
    if state == stamp.INCOMPLETE:
        reason = "set-up makes .venv itself and touches none that somebody else made"
        return fail(f".venv is {STATES[state]}", reason, f"mv .venv .venv-mine && {SET_UP}")
    return warn(STATES[state], "the notebooks run in an environment that set-up makes in .venv", SET_UP)


def venv_module(python: Interpreter, ready: bool) -> Check:
    """Debian and Ubuntu ship the venv module as a package of its own."""
    if ready or python.has_venv:
        return passed("not needed any more" if ready else "there")
    cure = f"sudo apt-get install -y {apt_package(python.version, 'venv')}"
    return fail("missing", "set-up makes the environment with it", cure)


def conda(environ: Mapping[str, str]) -> Check:
    """An active conda environment."""
    folder = environ.get("CONDA_PREFIX", "")
    if not folder:
        return passed("no conda environment is active")
    reason = "its compiler, libraries and Python come first and can mix with those of ROS 2"
    return warn(f"{folder} is active", reason, "conda deactivate")


def python_path(environ: Mapping[str, str]) -> Check:
    """PYTHONPATH entries other than those of a sourced ROS or workspace, which have a check of their own."""
    sourced = split_paths(environ.get("AMENT_PREFIX_PATH", ""))
    foreign = [
        entry
        for entry in split_paths(environ.get("PYTHONPATH", ""))
        if not any(Path(entry).is_relative_to(prefix) for prefix in sourced)
    ]
    if not foreign:
        return passed("nothing foreign")
    shadows = [package for package in OURS if any(Path(entry, package).is_dir() for entry in foreign)]
    if not shadows:
        reason = "modules in these folders come before the course's own"
        return warn(" ".join(foreign), reason, "unset PYTHONPATH")
    reason = f"Python would load {', '.join(shadows)} from there and not from the course's environment"
    report = fail if set(shadows) & set(ROS_PACKAGES) else warn
    return report(" ".join(foreign), reason, "unset PYTHONPATH")


def compiler(environ: Mapping[str, str], python: Interpreter, ros: RosInstallation | None, ready: bool) -> Check:
    """Python.h and a C++ compiler: what set-up and chapter 2 compile with."""
    packages = [] if ready else interfaces_to_compile(ros)
    chapter = "the packages that you build in chapter 2 need it; the other chapters do not"
    if not python.has_headers:
        report, reason = (fail, f"set-up compiles {' and '.join(packages)} for Python") if packages else (warn, chapter)
        cure = f"sudo apt-get install -y {apt_package(python.version, 'dev')}"
        return report(f"Python.h of {python.path} is missing", reason, cure)
    found = of_the_machine(environ)
    if found:
        return passed(found)
    if ready and ZIG in python.distributions:
        return passed(f"{ZIG} {python.distributions[ZIG]}, which set-up has brought: there is no c++")
    instead = f"set-up will fetch the compiler {ZIG} instead (100 MB) and take about a minute longer"
    return warn("no c++", instead if packages else chapter, "sudo apt-get install -y g++")
