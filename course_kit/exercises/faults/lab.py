"""The fault lab: a robot of four programs with a fault in it, for the student to find and to repair."""

from __future__ import annotations

import contextlib
import subprocess
import textwrap
import threading
from dataclasses import dataclass, field
from functools import partial

from course_kit.base.arguments import TEXT, WAIT, takes
from course_kit.base.long_tasks import long_task
from course_kit.base.polling import wait_until
from course_kit.base.programs.child_process import Process
from course_kit.base.text import table
from course_kit.exercises.faults import all_faults, health, robots_manual
from course_kit.exercises.faults.fault import PROGRAMS, Fault
from course_kit.exercises.faults.report import Report
from course_kit.exercises.faults.system import System
from course_kit.lab.node_logs import rosout
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.spinning import context

REPAIR_TIMEOUT = 12.0  # seconds given to a repaired robot: discovery, the next map, and two seconds of being well
COMMAND_TIMEOUT = 20.0
POLL = 0.1
NO_FAULT = "No fault is in the robot. Write: faults.start('qos'), or faults.start(seed=1) for one that you do not know."
WELL = "The robot runs and nothing is wrong with it. `faults.manual()` says what belongs where."


@dataclass
class _Lab:
    """What goes on in this notebook."""

    system: System = field(default_factory=System)
    fault: Fault | None = None
    hints_given: int = 0
    cause_found: bool = False


_lab = _Lab()
_lock = threading.RLock()


def start(name: str | None = None, *, seed: int | None = None) -> Report:
    """Start the robot with a fault: a named one, or one picked by `seed`; without both, a robot that is well.

    A robot that runs already is started anew where it must be, and what was repaired is undone.
    """
    if name is not None and seed is not None:
        return _refused("a fault is named or picked by a seed, not both")
    try:
        fault = all_faults.pick(seed) if seed is not None else all_faults.find(name) if name is not None else None
    except (TypeError, ValueError) as error:
        return _refused(str(error))
    with _lock:
        _lab.fault, _lab.hints_given, _lab.cause_found = fault, 0, False
        if _lab.system.ghost_seconds > 1.0:
            print(f"The node that was killed is still listed: this takes {_lab.system.ghost_seconds:.0f} seconds more.")
        try:
            rosout.collect()  # so that logs() has what the programs say at their start
            with long_task("starting the robot"):
                _lab.system.start(fault)
        except (OSError, RuntimeError) as error:
            stop()
            return _refused(f"the robot could not be started: {error}")
    return symptom()


def symptom() -> Report:
    """What the robot's owner complains about, and the causes to choose from."""
    if not _lab.system.is_running:
        return Report(NO_FAULT, False)
    if _lab.fault is None:
        return Report(WELL)
    options = [(fault.id, fault.cause) for fault in all_faults.options(_lab.fault)]
    causes = textwrap.indent(table(options, left=2), "  ")
    return Report(f"{_lab.fault.symptom}\n\nOne of these is the cause. Which? faults.answer('…')\n{causes}")


def hint() -> Report:
    """The next hint: from a gentle one to one that nearly says it."""
    if _lab.fault is None:
        return Report(NO_FAULT, False)
    hints = _lab.fault.hints
    number = min(_lab.hints_given, len(hints) - 1)
    _lab.hints_given = number + 1
    return Report(f"Hint {number + 1} of {len(hints)}: {hints[number]}")


@takes(cause=TEXT)
def answer(cause: str) -> Report:
    """State the cause, by its id; says whether it is right, and if not, what one would see if it were."""
    if _lab.fault is None:
        return Report(NO_FAULT, False)
    try:
        stated = all_faults.find(cause)
    except ValueError as error:
        return _refused(str(error).replace("fault", "cause", 1))
    if stated.id != _lab.fault.id:
        return Report(f"Not this. {stated.evidence}", False)
    _lab.cause_found = True
    return Report(f"Right. {stated.cause} Now repair it, then ask faults.is_repaired().")


@takes(timeout=WAIT)
def is_repaired(timeout: float = REPAIR_TIMEOUT) -> Report:
    """Look at the robot from outside until it has been well for two seconds, or `timeout` seconds are over."""
    if not _lab.system.is_running:
        return Report(NO_FAULT, False)
    context.start()  # the first context of a process sets its logging up
    # In a ROS context for the length of a look, so that its subscriptions are in nobody's way afterwards.
    with contextlib.closing(DomainObserver(None, only_here=False)) as observer:
        observer.known(health.WINDOW)
        with long_task("looking at the robot", timeout, at_most=True):
            findings = health.examine(observer, timeout, partial(wait_until, poll=POLL))
    is_well = all(finding.ok for finding in findings)
    heading = "Repaired." if _lab.fault is not None else "The robot is well."
    lines = [heading if is_well else "Not yet: the robot is not well.", *map(str, findings)]
    if is_well and _lab.fault is not None and not _lab.cause_found:
        lines.append("What was the cause? faults.answer('…')")
    return Report("\n".join(lines), is_well)


def solution() -> Report:
    """The cause, and a cell that repairs it."""
    if _lab.fault is None:
        return Report(NO_FAULT, False)
    cell = textwrap.indent(_lab.fault.repair, "    ")
    commands = "\n".join(f"    %{command}" for command in _lab.fault.commands)
    return Report(f"{_lab.fault.id}: {_lab.fault.cause}\n\nSeen with\n\n{commands}\n\nRepaired by\n\n{cell}")


def stop() -> None:
    """End all programs of the robot, also those that you started in their place."""
    with _lock:
        _lab.system.stop()
        _lab.fault = None


def catalogue() -> Report:
    """All causes that the lab knows, by their ids."""
    rows = [("id", "cause"), *((fault.id, fault.cause) for fault in all_faults.FAULTS.values())]
    return Report(table(rows, left=2))


def manual() -> Report:
    """What the robot's programs are, what is there when all is well, and how each is started."""
    return Report(robots_manual.text())


@takes(program=TEXT)
def process(program: str) -> Process:
    """The process that runs a program of the robot, or ran it last: its state, its pid, its lines.

    Raises ValueError for a program that the robot does not have, or that was not started.
    """
    if program not in PROGRAMS:
        raise ValueError(f"{program!r} is none of the robot's programs: {', '.join(PROGRAMS)}")
    if (process := _lab.system.process(program)) is None:
        raise ValueError(f"{program!r} was not started")
    return process


@takes(program=TEXT, command=TEXT)
def terminal(program: str, command: str) -> Report:
    """Type a command into the terminal in which a program was started, and see what it prints.

    `faults.terminal('scanner', 'printenv PATH')`; a command line without a shell.
    """
    try:
        return Report(_lab.system.terminal(program, command, COMMAND_TIMEOUT) or "(it printed nothing)")
    except LookupError:
        return _refused(f"{program!r} was not started from a terminal. There are {', '.join(PROGRAMS)}")
    except subprocess.TimeoutExpired:
        return _refused(f"`{command}` still ran after {COMMAND_TIMEOUT:g} s. Give it an end, such as --duration 3")
    except (OSError, ValueError) as error:
        return _refused(f"`{command}` cannot be run: {error}")


def _refused(reason: str) -> Report:
    return Report(f"faults: {reason}", False)
