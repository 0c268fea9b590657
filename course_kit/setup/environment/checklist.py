"""All checks, in the order of the report."""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from course_kit.setup.environment import stamp
from course_kit.setup.environment.activation import RosInstallation, installations, sourced_ros
from course_kit.setup.environment.checks import machine, network, notebook, python, ros
from course_kit.setup.environment.interpreter import Interpreter, probe, this_interpreter
from course_kit.setup.environment.report import Check, warn


@dataclass(frozen=True)
class Subject:
    """What is checked: an environment of variables, and the Python that the course runs on or will run on."""

    environ: Mapping[str, str]
    python: Interpreter
    state: str  # of .venv, as course_kit.setup.environment.stamp says it
    ready: bool  # whether that Python has the course's packages

    @property
    def ros(self) -> RosInstallation | None:
        """The ROS 2 that is sourced, if one is."""
        return sourced_ros(self.environ)


def of_this_python(environ: Mapping[str, str] = os.environ) -> list[Check]:
    """The checks of the environment that this Python runs in: a notebook's kernel."""
    state = stamp.FOREIGN  # whoever made it: this Python runs in it, so it is what counts
    return run(Subject(environ, probe(sys.executable, environ), state, ready=True))


def of_project(environ: Mapping[str, str], state: str) -> list[Check]:
    """The checks of environment-check.sh, which may run before there is an environment."""
    venv_python = str(stamp.ROOT / ".venv/bin/python")
    if state not in stamp.USABLE:
        return run(Subject(environ, this_interpreter(), state, ready=False))
    try:
        found = probe(venv_python, environ)
    except (OSError, ValueError):  # somebody removed part of it
        found = replace(this_interpreter(), path=venv_python, prefix=str(stamp.ROOT / ".venv"))
    return run(Subject(environ, found, state, ready=True))


def before_set_up(environ: Mapping[str, str]) -> list[Check]:
    """The checks of what no set-up can change."""
    return run(Subject(environ, this_interpreter(), stamp.MISSING, ready=False), GIVEN)


def run(subject: Subject, names: Iterable[str] = ()) -> list[Check]:
    """Look at everything, or at what is named; a check that cannot look says so and does not stop the others."""
    return [_look(name, CHECKS[name], subject) for name in names or CHECKS]


def _look(name: str, check: Callable[[Subject], Check], subject: Subject) -> Check:
    try:
        found = check(subject) if subject.ready or name not in AFTER_SET_UP else python.NOT_SET_UP
    except Exception as error:
        reason = f"the check itself failed: {type(error).__name__}: {error}"
        found = warn("not known", reason, "./environment-check.sh --json, and report what it prints")
    return replace(found, name=name)


CHECKS: dict[str, Callable[[Subject], Check]] = {
    "operating system": lambda s: machine.operating_system(platform.system(), machine.os_release(), platform.release()),
    "C library": lambda s: machine.c_library(machine.c_library_version()),
    "architecture": lambda s: machine.architecture(platform.machine(), s.ros is not None),
    "memory": lambda s: machine.memory(*machine.available_memory()),
    "disk": lambda s: machine.disk(stamp.ROOT, s.ready),
    "Python": lambda s: python.version(s.python, s.ros, s.environ),
    "venv module": lambda s: python.venv_module(s.python, s.ready),
    "conda": lambda s: python.conda(s.environ),
    "PYTHONPATH": lambda s: python.python_path(s.environ),
    "compiler": lambda s: python.compiler(s.environ, s.python, s.ros, s.ready),
    "environment": lambda s: python.set_up(s.state, s.python),
    "sourced ROS": lambda s: ros.other_installations(installations(s.environ), s.environ),
    "ROS 2": lambda s: ros.installation(s.ros, s.python, s.ready),
    "RMW_IMPLEMENTATION": lambda s: ros.middleware(s.environ, s.ros, s.python.prefix, s.ready),
    "ROS_DOMAIN_ID": lambda s: ros.domain(s.environ, os.getuid()),
    "discovery range": lambda s: ros.discovery(s.environ),
    "loopback": lambda s: network.loopback(),
    "shared memory": lambda s: network.shared_memory(),
    "ROS 2 node": lambda s: ros.node(ros.round_trip(s.python.path, s.environ)),
    "JupyterLab": lambda s: notebook.jupyterlab(s.python),
    "widgets": lambda s: notebook.widgets(s.python),
    "port": lambda s: network.ports(),
    "browser": lambda s: notebook.browser(s.environ, machine.is_wsl(platform.release())),
}
AFTER_SET_UP = ("ROS 2 node", "JupyterLab", "widgets")  # what can be looked at only then
GIVEN = ("operating system", "C library", "architecture")
