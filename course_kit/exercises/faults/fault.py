"""A fault: its symptom, its cause, its hints, and how the robot is started with it. Pure data."""

from __future__ import annotations

from dataclasses import dataclass

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


HEALTHY = {program: Start(program) for program in PROGRAMS} | {PLANNER: planner()}


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
    alike: tuple[str, ...]  # other causes that are offered with it
    commands: tuple[str, ...]  # command lines that show it
    start: Start | None = None  # the program that is started otherwise, and how
    missing: str = ""  # the program that is not started
    extra: tuple[Start, ...] = ()  # started too, before the others, without a console
    cure: str = ""  # a cell that repairs it; unless given, it is enough to start the program as it should be
    says: str = ""  # what the planner prints once the fault has shown itself
    killed: str = ""  # the program that is killed once it has run

    @property
    def programs(self) -> dict[str, Start | None]:
        """The programs that are started otherwise; None: not at all."""
        return {self.start.program: self.start} if self.start else {self.missing: None} if self.missing else {}

    @property
    def repair(self) -> str:
        """A cell that repairs it."""
        return self.cure or "\n".join(map(restart, self.programs))
