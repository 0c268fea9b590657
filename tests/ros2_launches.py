"""Runs `ros2 launch` and `ros2 run` in processes of their own and reads what they print while they run."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from tests.ros2_running import Running

ROOT = Path(__file__).resolve().parents[1]
PROGRAMS = ROOT / "tests/programs"
IMPORTS = """
import os, sys
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.events.process import *
from launch.launch_description_sources import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.parameter_descriptions import *
from launch_ros.substitutions import *

def python(code, **options):
    options = {"name": "child", "output": "screen"} | options
    return ExecuteProcess(cmd=[sys.executable, "-S", "-u", "-c", code], **options)

def generate_launch_description():
    return LaunchDescription([
"""


class Prefix:
    """A place that packages are installed to, as a workspace built by colcon has it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.environment = {
            "AMENT_PREFIX_PATH": os.pathsep.join([str(folder), os.environ.get("AMENT_PREFIX_PATH", "")]),
            "ROS_LOG_DIR": str(folder / "log"),
            "PYTHONDONTWRITEBYTECODE": "1",
        }

    def package(self, name: str) -> Path:
        """Make a package; return its share directory."""
        index = self.folder / "share/ament_index/resource_index/packages"
        index.mkdir(parents=True, exist_ok=True)
        (index / name).touch()
        share = self.folder / "share" / name
        share.mkdir(exist_ok=True)
        (self.folder / "lib" / name).mkdir(parents=True, exist_ok=True)
        return share

    def program(self, package: str, name: str, code: str) -> Path:
        """Install a Python program as an executable of a package."""
        path = self.folder / "lib" / package / name
        path.parent.mkdir(parents=True, exist_ok=True)
        # Started by the shell, because a script's first line must not name a Python with a space in its path.
        source = self.folder / "source" / package / f"{name}.py"
        source.parent.mkdir(parents=True, exist_ok=True)
        source.write_text(code)
        path.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{source}" "$@"\n')
        path.chmod(0o755)
        return path

    def node(self, package: str, name: str) -> Path:
        """Install tests/programs/launched_node.py under a name."""
        return self.program(package, name, (PROGRAMS / "launched_node.py").read_text())

    def launch_file(self, package: str, name: str, entities: str) -> Path:
        """Install a launch file that describes the entities."""
        path = self.package(package) / name
        path.write_text(f"{IMPORTS}{entities}\n    ])\n")
        return path


class RunningGroup(Running):
    """A running `ros2 launch` or `ros2 run` with all its processes; stdout and stderr go into `lines` together."""

    def __init__(self, *words: str | Path, environment: dict[str, str]) -> None:
        super().__init__(*words, stderr=subprocess.STDOUT, environment=environment, own_group=True)

    @property
    def text(self) -> str:
        return "\n".join(self.lines)

    def wait_for(self, pattern: str, count: int = 1) -> list[str]:
        """Wait until lines match a pattern; return what its groups matched, or the lines."""
        self._wait(lambda: len(self._found(pattern)) >= count, pattern)
        return self._found(pattern)

    def _found(self, pattern: str) -> list[str]:
        matches = [re.search(pattern, line) for line in self.lines]
        return [m.group(m.re.groups) for m in matches if m]

    def reports(self, count: int = 1) -> list[dict[str, Any]]:
        """What launched_node.py printed, by the name of the node."""
        found = self.wait_for(r"^(?:\[\S+\] )?(\{.*\})$", count)
        return sorted((json.loads(line) for line in found), key=lambda report: str(report["name"]))

    def pids(self, count: int = 1) -> list[int]:
        """The process ids that the launch told."""
        return [int(pid) for pid in self.wait_for(r"process started with pid \[(\d+)\]", count)]

    def interrupt(self) -> None:
        """Ctrl-C: SIGINT to the whole process group."""
        os.killpg(self.process.pid, signal.SIGINT)

    def __enter__(self) -> RunningGroup:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.interrupt()
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                os.killpg(self.process.pid, signal.SIGKILL)
                self.process.wait()


def is_alive(pid: int) -> bool:
    """Return True if a process runs; a zombie does not."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


def none_left(pids: Iterable[int]) -> bool:
    """Return True if all these processes have ended."""
    return not any(is_alive(pid) for pid in pids)
