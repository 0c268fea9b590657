"""One notebook to be graded, as the process that runs it gets it in a folder, with the notebook. Pure: no ROS."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

CHECK_TIMEOUT = 300.0  # seconds of the other cells; the checker ends its checks by itself
JOB, LINES = "job.json", "found.jsonl"  # in the job's folder: what is to be done, and what was found
SRC = "src"  # there, too: the workspace that was handed in
BEGUN, FOUND = "begun", "found"


@dataclass(frozen=True)
class Job:
    """Where things are, as the process sees them."""

    socket: str  # of the checker
    work: str  # the kernel's folder
    additions: Mapping[str, str]  # to the checker's environment

    def to_json(self) -> dict[str, Any]:
        """A form that json.dumps takes."""
        return asdict(self)

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> Job:
        """The job that to_json() made this of."""
        return Job(**data)
