"""The results of grading: of one exercise, of one student; as JSON and back. Pure: no ROS, no Jupyter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from course_kit.exercises.protocol.verdict import Verdict


@dataclass(frozen=True)
class ExerciseResult:
    """One exercise of one student. What the verdict says counts; the rest is shown."""

    verdict: Verdict  # points, findings with hints, the seed by which it can be repeated; or its note says why not
    shown: str = ""  # what the answer's cell printed or raised, shortened
    seconds: float = 0.0  # that the answer and its check took
    tries: int = 1  # how often it was checked: once more, alone, where time was wanting

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> ExerciseResult:
        """The result that asdict() made this of. KeyError or TypeError for anything else."""
        return ExerciseResult(**{**data, "verdict": Verdict.from_json(data["verdict"])})


@dataclass(frozen=True)
class StudentResult:
    """All exercises that were asked for, of one student."""

    student: str  # as the learning system's export calls her: a folder, or the beginning of a file's name
    exercises: tuple[ExerciseResult, ...]  # in the order of the course, the ones without an answer too
    notes: tuple[str, ...] = ()  # what instructor and student must be told about the hand-in
    ids: Mapping[str, str] = field(default_factory=dict)  # by which a learning system knows her, see handins.py
    late: bool = False
    protection: str = ""  # what kept the student's code apart, in a sentence

    @property
    def points(self) -> int:
        """The points of all exercises."""
        return sum(each.verdict.points for each in self.exercises)

    @property
    def max_points(self) -> int:
        """The points that there are."""
        return sum(each.verdict.max_points for each in self.exercises)

    def to_json(self) -> dict[str, Any]:
        """A form that json.dumps takes and from_json reads."""
        return {**asdict(self), "points": self.points, "max_points": self.max_points}

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> StudentResult:
        """The result that to_json() made this of. KeyError or TypeError for anything else."""
        values = {name: value for name, value in data.items() if name not in ("points", "max_points")}
        exercises = tuple(map(ExerciseResult.from_json, values["exercises"]))
        return StudentResult(**{**values, "exercises": exercises, "notes": tuple(values["notes"])})
