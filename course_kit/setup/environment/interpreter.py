"""A Python that the course could run on, or runs on: what it is and what it lacks.

environment-check.sh runs this file with each Python it finds, so it must not need anything newer than 3.10:

    python -m course_kit.setup.environment.interpreter

Its exit status is 0: fit; 3: another version is needed, but the checks run; 4: the packages printed have to be
installed first; 5: it is too old for the checks, too. With 3 and 5 it prints the cure.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from course_kit.setup.environment.activation import RosInstallation, has_package, sourced_ros

OLDEST, NEWEST = (3, 10), (3, 14)  # the ROS 2 wheels exist for these
INTERFACES = Path(__file__).resolve().parents[1] / "interfaces"
KINDS = ("msg", "srv", "action")
WRONG_VERSION, LACKS_PACKAGES, TOO_OLD = 3, 4, 5
SET_UP = "./environment-check.sh lab"
TIMEOUT = 30.0


@dataclass(frozen=True)
class Interpreter:
    """Facts about one Python."""

    path: str
    version: tuple[int, int, int]
    prefix: str
    has_venv: bool
    has_headers: bool
    distributions: Mapping[str, str] = field(default_factory=dict)  # name -> version, of what is installed
    unmet: Sequence[str] = ()  # pins of the lock that are not installed at their version
    rclpy: str = ""  # the folder that `import rclpy` would load


def supported(version: Sequence[int], ros: RosInstallation | None) -> bool:
    """Return True if the course runs on this version: that of a sourced ROS 2 where there is one."""
    if ros is not None:
        minor = ".".join(map(str, version[:2]))
        return Path(ros.prefix, f"lib/python{minor}/site-packages/rclpy").is_dir()
    return OLDEST <= tuple(version[:2]) <= NEWEST


def packages_to_install(ros: RosInstallation | None) -> list[str]:
    """The ROS packages of the course that no sourced ROS 2 brings."""
    names = sorted(path.parent.name for path in INTERFACES.glob("*/package.xml"))
    return [name for name in names if ros is None or not has_package(ros.prefix, name)]


def interfaces_to_compile(ros: RosInstallation | None) -> list[str]:
    """Those of them that define interfaces."""
    return [name for name in packages_to_install(ros) if any((INTERFACES / name / kind).is_dir() for kind in KINDS)]


def apt_package(version: Sequence[int], part: str) -> str:
    """The apt package with a part of a Python that Debian ships apart: venv, dev."""
    return f"python{version[0]}.{version[1]}-{part}"


def another_python(ros: RosInstallation | None, environ: Mapping[str, str]) -> str:
    """Return the command that sets the course up with a Python that fits, where this one does not.

    apt has one Python in each release. Where that is too old or too new, uv brings another, without root.
    """
    if environ.get("PYTHON"):
        return f"unset PYTHON; {SET_UP}"  # which then looks for one that fits
    if ros is not None:
        return f"sudo apt-get install -y python3 python3-venv python3-dev && PYTHON=/usr/bin/python3 {SET_UP}"
    newest = "{}.{}".format(*NEWEST)
    uv = "uv" if shutil.which("uv", path=environ.get("PATH")) else "sudo apt-get install -y pipx && pipx run uv"
    return f"{uv} python install {newest} && PYTHON=~/.local/bin/python{newest} {SET_UP}"


def this_interpreter() -> Interpreter:
    """The Python that runs this."""
    return Interpreter(
        path=sys.executable,
        version=sys.version_info[:3],
        prefix=sys.prefix,
        has_venv=all(map(importlib.util.find_spec, ("venv", "ensurepip"))),
        has_headers=Path(sysconfig.get_path("include"), "Python.h").exists(),
    )


def this_environment() -> Interpreter:
    """The same with what is installed."""
    from importlib.metadata import distributions

    from course_kit.setup.environment import pins, stamp

    # Spelt as the lock spells them.
    installed = {re.sub("[-_.]+", "-", d.metadata["Name"]).lower(): d.version for d in distributions()}
    level = stamp.level_of(Path(sys.prefix))
    wanted = applicable(pins.requirements(with_ros=sourced_ros(os.environ) is None, level=level))
    spec = importlib.util.find_spec("rclpy")
    return replace(
        this_interpreter(),
        distributions=installed,
        unmet=[f"{name}=={version}" for name, version in wanted if installed.get(name) != version],
        rclpy=str(Path(spec.origin).parent) if spec and spec.origin else "",
    )


def applicable(requirements: Sequence[str]) -> list[tuple[str, str]]:
    """(name, version) of the pins meant for this Python and machine; none if nothing is installed to tell."""
    try:
        from packaging.requirements import Requirement
    except ImportError:
        return [("packaging", "")]  # JupyterLab depends on it, so the environment is not complete
    parsed = [Requirement(line) for line in requirements]
    return [
        (r.name.lower(), next(iter(r.specifier)).version) for r in parsed if r.marker is None or r.marker.evaluate()
    ]


def ask(python: str, environ: Mapping[str, str], module: str, argument: str, timeout: float) -> dict[str, Any]:
    """What a module of this room says as JSON in its last line, run by another Python; timeout in seconds.

    OSError, TimeoutExpired or ValueError, with that Python's last words, if it does not answer.
    """
    process = subprocess.Popen(
        [python, "-B", "-m", f"course_kit.setup.environment.{module}", argument],
        cwd=INTERFACES.parents[2],
        env=dict(environ),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        output, errors = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        raise
    if process.returncode:
        lines = errors.strip().splitlines()
        raise ValueError(lines[-1] if lines else f"{python} ended with exit status {process.returncode}")
    found: dict[str, Any] = json.loads((output.splitlines() or [""])[-1])
    return found


def probe(python: str, environ: Mapping[str, str]) -> Interpreter:
    """Ask the Python of an environment. OSError or ValueError if it does not answer."""
    facts = ask(python, environ, "interpreter", "--json", TIMEOUT)
    return Interpreter(**facts | {"version": tuple(facts["version"])})


def main(arguments: Sequence[str]) -> int:
    """What the script asks of an interpreter."""
    if "--json" in arguments:
        print(json.dumps(asdict(this_environment())))
        return 0
    ros, python = sourced_ros(os.environ), this_interpreter()
    if not supported(python.version, ros):
        print(another_python(ros, os.environ))
        return WRONG_VERSION if python.version >= OLDEST else TOO_OLD
    has = {"venv": python.has_venv, "dev": python.has_headers or not interfaces_to_compile(ros)}
    print(*(apt_package(python.version, part) for part in has if not has[part]))
    return 0 if all(has.values()) else LACKS_PACKAGES


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
