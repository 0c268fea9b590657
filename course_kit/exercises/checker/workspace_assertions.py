"""Assertions about a workspace: packages that are built, programs and launches that run, definitions of types.

Programs are started as a student would in a terminal in which the workspace is sourced, but in the test domain. They
end with the check. What a student wrote is read as data, and only from regular files.
"""

from __future__ import annotations

import contextlib
import os
import signal
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import psutil  # type: ignore[import-untyped]
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.parameter import Parameter, parameter_value_to_python

from course_kit.base.programs.child_process import Process
from course_kit.exercises.checker import definitions, own_types, workspace_terminal
from course_kit.exercises.checker.assertions import expect, nearest, pause, require, wait
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.service_assertions import Client
from course_kit.exercises.checker.workspace_terminal import folder
from course_kit.exercises.notebook_folder import WORKSPACE
from course_kit.ros.private_api.rmw_parts import service_topics
from course_kit.setup.colcon import built, console_scripts, overlay, regular_files

START_TIMEOUT = 15.0  # seconds that programs have until their nodes are there
LONGEST_START = 45.0  # the same as long as they still begin, on a busy machine
SAMPLES = 20  # of whether a program wants to run, 50 ms apart
STOP_PATIENCE = 2.0
INTERRUPT_TIMEOUT = 7.0  # seconds that a program has to end after Ctrl-C, some of them for a busy machine


def share(package: str) -> Path:
    """The folder of an installed package for launch files, parameter files and definitions."""
    return overlay.prefix_of(folder(), package) / "share" / package


def expect_package(package: str, build_type: str, points: int = 0) -> None:
    """The workspace has this package, and what colcon has installed of it is what lies in `src` now."""
    manifests = {path.parent.name: path for path in (folder() / "src").glob("*/package.xml")}
    names = ", ".join(sorted(manifests)) or "no packages"
    hint = f"{nearest(package, list(manifests))}In {WORKSPACE}/src there are: {names}."
    require(f"`{WORKSPACE}/src` has the package `{package}`", package in manifests, hint)
    stated = _build_type(manifests[package])
    hint = f"Its package.xml says {stated}. Remove the folder, and make it anew with `--build-type {build_type}`."
    require(f"its build type is {build_type}", stated == build_type, hint)
    expect(f"`{package}` is built", not (hint := _unbuilt(package, build_type)), hint, points, needed=True)
    if changed := built.changed(folder(), package):
        names = ", ".join(str(path.relative_to(folder())) for path in changed)
        hint = f"{names} is newer than what is installed, or what is installed was changed by hand. "
        require("what is installed is what is in `src`", False, f"{hint}Build again, then run this cell again.")


def _unbuilt(package: str, build_type: str) -> str:
    """Why a package is not built; nothing if it is."""
    prefix = overlay.prefix_of(folder(), package)
    if not (prefix / "share/ament_index/resource_index/packages" / package).is_file():
        if (folder() / "src/install" / package).is_dir():
            hint = f"It is in {WORKSPACE}/src/install: you built in `src`. Remove build, install and log there, and "
            return f"{hint}build in {WORKSPACE}."
        return f"There is no {WORKSPACE}/install/{package}: `colcon build --packages-select {package}`, beside `src`."
    if build_type == "ament_python" and built.is_made_by_hand(folder(), package):
        hint = f"What lies in {prefix.relative_to(current().folder)} was not built from `src`: the .dsv and .egg-info "
        hint += "that every build leaves are not there. "
        return f"{hint}Remove it, and run `colcon build --packages-select {package}` beside `src`."
    return ""


def _build_type(package_xml: Path) -> str:
    try:
        stated = ElementTree.fromstring(regular_files.data_of(package_xml) or b"").findtext("export/build_type")
        return (stated or "nothing about it").strip()
    except ElementTree.ParseError as error:
        return f"what cannot be read ({error})"


def expect_executable(package: str, name: str) -> None:
    """`ros2 run` knows this program of a package, and it is made of an entry point of its setup.py."""
    path = overlay.prefix_of(folder(), package) / "lib" / package
    programs = sorted(file.name for file in path.glob("*") if os.access(file, os.X_OK))
    hint = (
        f"{nearest(name, programs)}`ros2 run` finds {', '.join(programs) or 'no program'} in {package}: a program "
        f"needs a line `{name} = {package}.module:main` in console_scripts of setup.py, and a build."
    )
    require(f"`{package}` has the program `{name}`", name in programs, hint)
    if fault := console_scripts.fault(folder(), package, path / name):
        hint = f"{(path / name).relative_to(folder())} was not built from `src`: {fault}. "
        hint += "Only `colcon build` writes into `install`: remove the file, and build again."
        require(f"the program `{name}` is built from `src`", False, hint)


def expect_installed(package: str, file: str) -> None:
    """A file such as 'launch/a.launch.py' is in the package's share folder."""
    hint = (
        f"There is no {file} in {WORKSPACE}/install/{package}/share/{package}: `data_files` in setup.py says which "
        f"files are installed, and a build installs them."
    )
    require(f"`{file}` is installed", (share(package) / file).is_file(), hint)
    if not built.comes_from_source(folder(), package, share(package) / file):
        hint = f"No file of this name in {WORKSPACE}/src/{package} says what {WORKSPACE}/install has: build again."
        require(f"`{file}` is installed from `src`", False, hint)


def start(*command: str) -> Process:
    """Start a command in the test domain, in the workspace's folder; it ends with the check."""
    if names := workspace_terminal.in_the_way():
        hint = f"{', '.join(names)} has the name of a module of ROS or of the course, and would be loaded in its place."
        require("no module of the workspace stands in the way", False, f"{hint} Give it another name, and build again.")
    words = workspace_terminal.command(command)
    process = Process(
        [*workspace_terminal.confined(), *words], " ".join(command), workspace_terminal.environment(), folder()
    )
    current().ending.callback(process.stop, STOP_PATIENCE)
    current().programs.append(process.pid)
    process.begin()
    return process


def run_to_end(*command: str, timeout: float) -> Process:
    """Run a command in the test domain until it ends or the time is over."""
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
    observer = current().test_domain

    def missing() -> list[str]:
        observer.examine_processes(started())
        return [name for name in names if name not in observer.their_nodes()]

    def is_decided() -> bool:
        return not missing() or not process.is_running

    wait(is_decided, START_TIMEOUT, f"the nodes of `{process.name}`")
    wait(lambda: is_decided() or not _still_begins(process), LONGEST_START - START_TIMEOUT)
    observer.known(3.0)
    absent, present = missing(), observer.their_nodes()
    hint = f"There is no {', '.join(absent)}, there is {', '.join(present) or 'no node at all'}. {said(process)}"
    text = f"the node `{names[0]}` runs" if len(names) == 1 else f"the nodes {', '.join(f'`{n}`' for n in names)} run"
    return expect(text, not absent, hint, points, needed=True)


def started() -> list[int]:
    """The processes that were started, with those that they have started."""
    pids = []
    for pid in current().programs:
        with contextlib.suppress(psutil.Error):  # it has ended
            root = psutil.Process(pid)
            pids += [pid, *(child.pid for child in root.children(recursive=True))]
    return pids


def _still_begins(process: Process) -> bool:
    """Return True if one of its programs wants to run most of the time, as while it loads, and not while it spins.

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


def interrupt(process: Process) -> int | None:
    """Ctrl-C in the terminal of a program: its exit status, or None if it goes on for INTERRUPT_TIMEOUT seconds."""
    process.send_signal(signal.SIGINT)
    wait(process.done, INTERRUPT_TIMEOUT, f"the end of `{process.name}`")
    status = process.status
    process.stop(STOP_PATIENCE)
    return status


def expect_gone(node: str) -> None:
    """A node that was stopped has left the graph."""
    gone = wait(lambda: node not in current().test_domain.their_nodes(), 5.0, f"the end of {node}")
    require(f"`{node}` leaves the graph at Ctrl-C", gone, "It is still there: did it end without cleaning up?")


def set_parameter(node: str, name: str, value: Any) -> tuple[bool | None, str]:
    """Set a parameter of a node, as `ros2 param set` does; whether it took it, None without an answer, and why not."""
    request = [Parameter(name, value=value).to_parameter_msg()]
    response = Client(f"{node}/set_parameters", SetParameters).ask(parameters=request).response
    if response is None:
        return None, "no answer came: a callback raises or blocks, or it is not spun"
    return bool(response.results[0].successful), str(response.results[0].reason)


def get_parameters(node: str, *names: str) -> list[Any]:
    """The values of parameters of a node; None for what it has not declared."""
    response = Client(f"{node}/get_parameters", GetParameters).ask(names=list(names)).response
    values = [parameter_value_to_python(value) for value in response.values] if response is not None else []
    return values if len(values) == len(names) else [None] * len(names)


def expect_definition(package: str, name: str, points: int = 1) -> bool:
    """The installed definition, such as that of 'msg/Battery', is the checker's own but for order and remarks."""
    file = f"{name}.{name.split('/')[0]}"
    wanted, text = own_types.own_texts(package)[file], regular_files.text_of(share(package) / file) or ""
    hint = f"{package} has no {name}: is its file listed in rosidl_generate_interfaces(…) of CMakeLists.txt, and built?"
    if text:
        hint = f"It says: {definitions.shown(text)}. Types, names and constants must be those of the text, or nobody "
        hint += "else can read it."
    return expect(f"`{package}/{name}` is as asked", definitions.is_as_asked(text, wanted), hint, points)


def expect_same_types(topic: str, service: str) -> None:
    """The answer speaks the types that are installed, and so the checker's: their hashes say so."""
    observer = current().test_domain

    def hashes(name: str) -> set[str]:
        looks = observer.node.get_publishers_info_by_topic, observer.node.get_subscriptions_info_by_topic
        ends = [end for look in looks for end in look(name, no_mangle=name[0] != "/")]
        ids = [(end, bytes(end.endpoint_gid)) for end in ends]
        return {str(end.topic_type_hash) for end, gid in ids if observer.counts(gid) or observer.is_own(gid)}

    same = all(len(hashes(name)) <= 1 for name in (topic, *service_topics(service)))
    hint = "Its types are those of an earlier build: once imported, a type stays as it is. Restart the kernel, and run "
    if not same:
        require("its types are those that are built", False, f"{hint}the cells again. If that does not help, build.")
