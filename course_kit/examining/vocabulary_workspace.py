"""What checks say about a workspace: packages that are built, programs and launches that run, definitions of types.

Programs are started as a student would in a terminal in which the workspace is sourced, but on the stage. They end
with the check.
"""

from __future__ import annotations

import contextlib
import os
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import psutil  # type: ignore[import-untyped]
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.parameter import Parameter, parameter_value_to_python

from course_kit.colcon import sourcing
from course_kit.examining import own_types
from course_kit.examining.examination import WORKSPACE, current
from course_kit.examining.vocabulary import expect, nearest, pause, require, wait
from course_kit.examining.vocabulary_services import Client
from course_kit.programs import processes
from course_kit.programs.child_process import Process
from course_kit.spinning.context import RANGE

START_TIMEOUT = 15.0  # seconds that programs have until their nodes are there
LONGEST_START = 45.0  # the same as long as they still begin, on a busy machine
SAMPLES = 20  # of whether a program wants to run, 50 ms apart
STOP_PATIENCE = 2.0


def folder() -> Path:
    """The student's workspace."""
    return current().folder / WORKSPACE


def _prefix(package: str) -> Path:
    """Where a package is installed, or would be: in a folder of its own, unless all were merged into one."""
    own = folder() / "install" / package
    return own if own.is_dir() else folder() / "install"


def share(package: str) -> Path:
    """The folder of an installed package for launch files, parameter files and definitions."""
    return _prefix(package) / "share" / package


def expect_package(package: str, build_type: str, points: int = 0) -> None:
    """The workspace has this package, and what is installed of it is what lies in `src` now."""
    manifests = {path.parent.name: path for path in (folder() / "src").glob("*/package.xml")}
    names = ", ".join(sorted(manifests)) or "no packages"
    hint = f"{nearest(package, list(manifests))}In {WORKSPACE}/src there are: {names}."
    require(f"`{WORKSPACE}/src` has the package `{package}`", package in manifests, hint)
    stated = _build_type(manifests[package])
    hint = f"Its package.xml says {stated}. Remove the folder, and make it anew with `--build-type {build_type}`."
    require(f"its build type is {build_type}", stated == build_type, hint)
    marker = _prefix(package) / "share/ament_index/resource_index/packages" / package
    hint = f"There is no {WORKSPACE}/install/{package}: `colcon build --packages-select {package}`, beside `src`."
    if (folder() / "src/install" / package).is_dir():
        hint = f"It is in {WORKSPACE}/src/install: you built in `src`. Remove build, install and log there, and build "
        hint += f"in {WORKSPACE}."
    expect(f"`{package}` is built", marker.is_file(), hint, points, needed=True)
    if changed := [str(path.relative_to(folder())) for path in _changed(package)]:
        hint = f"{', '.join(changed)} is newer than what is installed: build again, then run this cell again."
        require("what is installed is what is in `src`", False, hint)


def _build_type(package_xml: Path) -> str:
    try:
        return ElementTree.parse(package_xml).findtext("export/build_type") or "nothing about it"
    except (ElementTree.ParseError, OSError) as error:
        return f"what cannot be read ({error})"


def _changed(package: str) -> list[Path]:
    """The files in `src` whose installed copy says something else."""
    source, prefix = folder() / "src" / package, _prefix(package)
    modules = list(prefix.glob(f"lib/python3*/site-packages/{package}"))
    copies = [(path, base / path.name) for base in modules for path in (source / package).glob("*.py")]
    for place in ("launch", "config", "msg", "srv", "action"):
        copies += [(path, share(package) / place / path.name) for path in (source / place).glob("*.*")]
    return [path for path, copy in copies if copy.is_file() and copy.read_bytes() != path.read_bytes()]


def expect_executable(package: str, name: str) -> None:
    """`ros2 run` knows this program of a package."""
    path = _prefix(package) / "lib" / package
    programs = sorted(file.name for file in path.glob("*") if os.access(file, os.X_OK))
    hint = (
        f"{nearest(name, programs)}`ros2 run` finds {', '.join(programs) or 'no program'} in {package}: a program "
        f"needs a line `{name} = {package}.module:main` in console_scripts of setup.py, and a build."
    )
    require(f"`{package}` has the program `{name}`", name in programs, hint)


def expect_installed(package: str, file: str) -> None:
    """A file such as 'launch/a.launch.py' is in the package's share folder."""
    hint = (
        f"There is no {file} in {WORKSPACE}/install/{package}/share/{package}: `data_files` in setup.py says which "
        f"files are installed, and a build installs them."
    )
    require(f"`{file}` is installed", (share(package) / file).is_file(), hint)


def _environment() -> dict[str, str]:
    """As in a terminal in which the workspace is sourced, on the stage."""
    try:
        environment = sourcing.sourced(folder() / "install/setup.bash", processes.without_kernel(os.environ))
    except (OSError, RuntimeError) as error:
        require(f"`{WORKSPACE}/install/setup.bash` can be sourced", False, f"{error}.")
        raise
    for name in ("ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_NAMESPACE"):
        environment.pop(name, None)
    return {**environment, **processes.PLAIN_TERMINAL, "ROS_DOMAIN_ID": str(current().stage.domain), RANGE: "LOCALHOST"}


def start(*command: str) -> Process:
    """Start a command on the stage, in the workspace's folder; it ends with the check."""
    process = Process(command, " ".join(command), _environment(), folder())
    current().ending.callback(process.stop, STOP_PATIENCE)
    current().programs.append(process.pid)
    process.begin()
    return process


def run_to_end(*command: str, timeout: float) -> Process:
    """Run a command on the stage until it ends or the time is over."""
    process = start(*command)
    wait(process.done, timeout, f"the end of `{process.name}`")
    return process


def said(process: Process, lines: int = 2) -> str:
    """The last lines of a program, as the beginning of a hint."""
    last = [line for line in process.lines if line.strip()][-lines:]
    state = "" if process.is_running else f"`{process.name}` has {process.state}. "
    return state + (f"Its last words: {' / '.join(last)}. " if last else "It wrote nothing. ")


def expect_nodes(process: Process, *names: str, points: int = 0) -> bool:
    """What was started has nodes of these full names."""
    station = current().stage

    def missing() -> list[str]:
        station.examine_processes(_theirs())
        return [name for name in names if name not in station.their_nodes()]

    def is_decided() -> bool:
        return not missing() or not process.is_running

    wait(is_decided, START_TIMEOUT, f"the nodes of `{process.name}`")
    wait(lambda: is_decided() or not _still_begins(process), LONGEST_START - START_TIMEOUT)
    station.known(3.0)
    absent, present = missing(), station.their_nodes()
    hint = f"There is no {', '.join(absent)}, there is {', '.join(present) or 'no node at all'}. {said(process)}"
    text = f"the node `{names[0]}` runs" if len(names) == 1 else f"the nodes {', '.join(f'`{n}`' for n in names)} run"
    return expect(text, not absent, hint, points, needed=True)


def _theirs() -> list[int]:
    """The processes that were started, with those that they have started."""
    pids = []
    for pid in current().programs:
        with contextlib.suppress(psutil.Error):  # it has ended
            root = psutil.Process(pid)
            pids += [pid, *(child.pid for child in root.children(recursive=True))]
    return pids


def _still_begins(process: Process) -> bool:
    """Whether one of its programs wants to run most of the time: while it loads it does, once it spins it rarely does.

    On a machine with enough to do for other processes, loading takes long.
    """
    busy = 0
    try:
        root = psutil.Process(process.pid)
        tree = [root, *root.children(recursive=True)]
    except psutil.Error:  # it has ended
        return False
    for _ in range(SAMPLES):
        busy += any(_wants_to_run(program) for program in tree)
        pause(0.05)
    return busy > SAMPLES / 2


def _wants_to_run(program: psutil.Process) -> bool:
    try:
        return bool(program.status() == psutil.STATUS_RUNNING)
    except psutil.Error:  # it has ended
        return False


def expect_gone(node: str) -> None:
    """A node that was stopped has left the graph."""
    gone = wait(lambda: node not in current().stage.their_nodes(), 5.0, f"the end of {node}")
    require(f"`{node}` leaves the graph at Ctrl-C", gone, "It is still there: did it end without cleaning up?")


def set_parameter(node: str, name: str, value: Any) -> tuple[bool, str]:
    """Set a parameter of a node, as `ros2 param set` does; whether it took it, and why not."""
    request = [Parameter(name, value=value).to_parameter_msg()]
    response = Client(f"{node}/set_parameters", SetParameters).ask(parameters=request).response
    if response is None:
        return False, "no answer came: its callbacks block, or it is not spun"
    return bool(response.results[0].successful), str(response.results[0].reason)


def get_parameters(node: str, *names: str) -> list[Any]:
    """The values of parameters of a node; None for what it has not declared."""
    response = Client(f"{node}/get_parameters", GetParameters).ask(names=list(names)).response
    values = [parameter_value_to_python(value) for value in response.values] if response is not None else []
    return values if len(values) == len(names) else [None] * len(names)


def expect_definition(package: str, name: str, points: int = 1) -> bool:
    """The installed definition, such as that of 'msg/Battery', is the checker's own but for order, spaces and remarks.

    The three dashes of a service part its lines: the order counts across them only.
    """
    file = f"{name}.{name.split('/')[0]}"
    path, wanted = share(package) / file, (own_types.DEFINITIONS[package][0] / file).read_text()
    text = path.read_text() if path.is_file() else ""
    shown = " / ".join(" ".join(line.split()) for line in text.splitlines() if line.strip())
    hint = f"{package} has no {name}: is its file listed in rosidl_generate_interfaces(…) of CMakeLists.txt, and built?"
    if text:
        hint = f"It says: {shown}. Types, names and constants must be those of the text, or nobody else can read it."
    return expect(f"`{package}/{name}` is as asked", _parts(text) == _parts(wanted), hint, points)


def _parts(text: str) -> list[list[str]]:
    parts: list[list[str]] = [[]]
    for line in text.splitlines():
        code = re.sub(r"\s*=\s*", "=", " ".join(line.split("#")[0].split()))
        if code == "---":
            parts.append([])
        elif code:
            parts[-1].append(_with_number(code))
    return [sorted(part) for part in parts]


def _with_number(code: str) -> str:
    """A constant with its value as a number: 11 is 11.0."""
    left, is_constant, value = code.partition("=")
    try:
        return f"{left}={float(value)}" if is_constant else code
    except ValueError:
        return code
