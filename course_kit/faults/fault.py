"""What a fault is: what the student is told, what is really wrong, and how the robot is started with it. Pure data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

SIMULATOR, SCANNER, MAP_SERVER, PLANNER = PROGRAMS = ("simulator", "scanner", "map_server", "planner")
REMAPPING = "cmd_vel:=turtle1/cmd_vel"


@dataclass(frozen=True)
class Start:
    """How one program is started: its ROS arguments, and in which terminal (a name of surroundings.TERMINALS)."""

    program: str
    arguments: tuple[str, ...] = ()
    terminal: str = "good"

    @property
    def command(self) -> str:
        """As it is typed."""
        arguments = f" --ros-args {' '.join(self.arguments)}" if self.arguments else ""
        return f"ros2 run patrol {self.program}{arguments}"


def planner(*arguments: str, terminal: str = "good") -> Start:
    """The planner as it should be started, and with more arguments."""
    return Start(PLANNER, ("-r", REMAPPING, *arguments), terminal)


HEALTHY = {
    SIMULATOR: Start(SIMULATOR),
    SCANNER: Start(SCANNER),
    MAP_SERVER: Start(MAP_SERVER),
    PLANNER: planner(),
}


def restart(program: str) -> str:
    """The line of a cell that starts a program as it should be, in the place of the one that runs."""
    return f'start("{HEALTHY[program].command}", name="{program}")'


@dataclass(frozen=True)
class Fault:
    """One fault. Its id is also the id of its cause, which the student states."""

    id: str
    cause: str  # one sentence, as an option to choose from
    symptom: str  # what the student is told
    evidence: str  # what one would see if it were this: the hint for whoever states it wrongly
    hints: tuple[str, ...]  # from a gentle one to one that nearly says it
    repair: str  # a cell that repairs it
    alike: tuple[str, ...]  # other causes that are offered with it
    looks: tuple[str, ...]  # command lines that show it
    programs: Mapping[str, Start | None] = field(default_factory=dict)  # those started otherwise; None: not at all
    extra: tuple[Start, ...] = ()  # started too, before the others, without a console
    says: str = ""  # what the planner prints once the fault has shown itself
    killed: str = ""  # the program that is killed once it has run
