"""The robot of the fault lab: four programs, each a process of its own, started well or with a fault."""

from __future__ import annotations

import atexit
import os
import shlex
import signal
import subprocess
import time
from collections.abc import Iterable, Sequence
from functools import partial

from course_kit.base.polling import wait_until
from course_kit.base.programs import processes
from course_kit.base.programs.child_process import Process
from course_kit.exercises.faults import terminals
from course_kit.exercises.faults.fault import HEALTHY, PLANNER, PROGRAMS, Fault, Start
from course_kit.ros.graph import discovery
from course_kit.ros.subscriptions import observer_node

PATIENCE = 1.5  # seconds that a program has to end, after SIGINT and again after SIGTERM
READY_TIMEOUT = 20.0
SAYS_TIMEOUT = 8.0  # seconds for what a program says when it has found, or missed, the others
WELL_TERMINALS = ("good", "long lease")  # in which a program that does not get ready is no fault of the lab's
READY = {
    "simulator": "Spawning turtle",
    "scanner": "the laser is on",
    "map_server": "the map is open",
    "planner": "the planner is ready",
}


class System:
    """The robot: which programs run, how and where they were started."""

    def __init__(self) -> None:
        self._started: dict[str, tuple[Start, Process]] = {}
        self._extra: list[Process] = []
        self._environments: dict[str, dict[str, str]] = {}
        self._killed_at = -1e9

    @property
    def is_running(self) -> bool:
        """True if the robot was started."""
        return bool(self._started)

    def process(self, program: str) -> Process | None:
        """The process that runs a program now, the student's if they have started it again."""
        named = [process for process in processes.running() if process.name == program]
        return named[0] if named else self._started[program][1] if program in self._started else None

    def start(self, fault: Fault | None) -> None:
        """Start the robot with a fault, or without one. Programs that run as they should go on, but for the planner."""
        terminals.source_robot()
        wanted: dict[str, Start | None] = {**HEALTHY, **(fault.programs if fault else {})}
        stay = [program for program in PROGRAMS if program != PLANNER and self._runs_as(program, wanted[program])]
        self.stop(except_for=stay)
        wait_until(lambda: self.ghost_seconds == 0.0, self.ghost_seconds + 1.0)
        for start in fault.extra if fault else ():
            extra = Process(_command(start), start.program, self._environment(start))
            extra.begin()
            self._extra.append(extra)
            wait_until(partial(_is_up, extra, start.program), READY_TIMEOUT)
        last = wanted.pop(PLANNER)  # it is to find the others there
        self._start_all([start for program, start in wanted.items() if start and program not in stay])
        self._start_all([last] if last else [])
        says, process = fault.says if fault else "driving", self._started[PLANNER][1]
        wait_until(lambda: process.says(says) or not process.is_running, SAYS_TIMEOUT)
        if fault and fault.killed:
            self._kill(fault.killed)

    def _kill(self, program: str) -> None:
        """Kill a program, once this process would list its node: it could not remember it otherwise."""
        node, process = observer_node.node(), self._started[program][1]
        known = discovery.of(node, keep=True)
        wait_until(lambda: (program, "/") in known.alive(node.get_node_names_and_namespaces()), READY_TIMEOUT)
        process.send_signal(signal.SIGKILL)
        wait_until(lambda: not process.is_running, READY_TIMEOUT)
        self._killed_at = time.monotonic()

    def _start_all(self, starts: Sequence[Start]) -> None:
        """Start programs at the same time, and wait until each is ready or has failed."""
        for start in starts:
            process = processes.start(_command(start), name=start.program, environment=self._environment(start))
            self._started[start.program] = start, process
        for start in starts:
            process = self._started[start.program][1]
            if not wait_until(partial(_is_up, process, start.program), READY_TIMEOUT):
                raise RuntimeError(f"{start.program} was not ready after {READY_TIMEOUT:g} s. {_last_line(process)}")
            if start.terminal in WELL_TERMINALS and not process.says(READY[start.program]):
                raise RuntimeError(f"{start.program} {process.state}. {_last_line(process)}")

    def _runs_as(self, program: str, start: Start | None) -> bool:
        before = self._started.get(program)
        if start is None or before is None or before[0] != start or before[1].stopped:
            return False
        return before[1].is_running and self.process(program) is before[1]

    def _environment(self, start: Start) -> dict[str, str]:
        terminal = terminals.TERMINALS[start.terminal]
        environment = {**terminal(processes.without_kernel(os.environ)), **processes.PLAIN_TERMINAL}
        self._environments[start.program] = environment
        return environment

    @property
    def ghost_seconds(self) -> float:
        """How long a program that was killed stays in the graph yet; the next fault is to begin without it."""
        return max(0.0, self._killed_at + terminals.STOCK_LEASE + 1.0 - time.monotonic())

    def terminal(self, program: str, command: str, timeout: float) -> str:
        """What a command prints in the terminal in which a program was started. LookupError if there is none."""
        if program not in self._environments:
            raise LookupError(program)
        done = subprocess.run(
            shlex.split(command),
            env=self._environments[program],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=timeout,
        )
        return done.stdout.rstrip()

    def stop(self, except_for: Iterable[str] = ()) -> None:
        """End its programs, also those that the student has started in their place."""
        stay = set(except_for)
        ending = [process for process in processes.running() if _is_of_robot(process) and process.name not in stay]
        processes.stop_all(PATIENCE, ending + self._extra)
        self._extra.clear()
        self._started = {program: pair for program, pair in self._started.items() if program in stay}
        if not stay:
            self._environments.clear()
        atexit.unregister(self.stop)
        atexit.register(self.stop)


def _is_of_robot(process: Process) -> bool:
    return process.name in PROGRAMS or process.command[1:3] == ("run", "patrol")


def _command(start: Start) -> list[str]:
    """What is really run: the executable itself, which spares a process each; `ros2 run` where that cannot find it."""
    if start.terminal == "not sourced":
        return start.command.split()
    return [str(terminals.executable(start.program)), *start.command.split()[4:]]


def _last_line(process: Process) -> str:
    return f"Its last line is: {process.lines[-1]}" if process.lines else "It has written nothing."


def _is_up(process: Process, program: str) -> bool:
    return process.says(READY[program]) or not process.is_running
