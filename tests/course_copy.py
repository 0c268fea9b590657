"""A copy of the course in a folder of its own, used as from a freshly opened terminal."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
BASE_PYTHON = str(Path(sys.base_prefix, f"bin/python{sys.version_info[0]}.{sys.version_info[1]}"))
PARTS = ("environment-check.sh", "pyproject.toml", "README.md", "LICENSE", "course_kit", "notebooks", "tests")
SET_UP = ("environment-check.sh", "pyproject.toml", "README.md", "LICENSE", "course_kit")  # all that it needs
UV = next(iter(ROOT.glob("build/uv-*/bin/uv")), None) or shutil.which("uv")
needs_uv = pytest.mark.skipif(UV is None, reason="there is no uv here: the environment of the tests was made with pip")
needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can mount")
# What activation and this test process have set, and a fresh terminal has not.
ACTIVATED = ("AMENT_", "CMAKE_", "COURSE_KIT_", "FASTDDS_", "FASTRTPS_", "LD_LIBRARY_PATH", "PYTHON", "ROS_", "_ROS_")


def fresh_environ(**variables: str) -> dict[str, str]:
    """The variables of a terminal in which nothing was sourced or activated, and `variables`."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(ACTIVATED)}
    kept.pop("VIRTUAL_ENV", None)
    own_bin = os.path.join(sys.prefix, "bin")
    kept["PATH"] = os.pathsep.join(entry for entry in kept["PATH"].split(os.pathsep) if entry != own_bin)
    return kept | {"ROS_DOMAIN_ID": os.environ["ROS_DOMAIN_ID"]} | variables


class CourseCopy:
    """The course's files, without what set-up, tools and chapters made; by default with a space in their path."""

    def __init__(self, folder: Path, parts: Sequence[str] = PARTS, name: str = "my course") -> None:
        self.root = folder / name
        self.root.mkdir(parents=True)
        ignore = shutil.ignore_patterns("__pycache__", ".*", "*_ws")
        for part in parts:
            source = ROOT / part
            if source.is_dir():
                shutil.copytree(source, self.root / part, ignore=ignore)
            elif source.exists():
                shutil.copy2(source, self.root / part)

    def start(self, *arguments: str, environ: Mapping[str, str] | None = None, view: str = "") -> subprocess.Popen[str]:
        """Start environment-check.sh from another folder; its output is captured as text.

        `view` is a shell command that mounts what only this command shall see; that takes root.
        """
        command = [str(self.root / "environment-check.sh"), *arguments]
        if view:
            command = ["unshare", "--mount", "sh", "-c", f'{view} && exec "$@"', "sh", *command]
        return subprocess.Popen(
            command,
            cwd=self.root.parent,
            env=dict(fresh_environ(PYTHON=BASE_PYTHON) if environ is None else environ),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def run(
        self,
        *arguments: str,
        environ: Mapping[str, str] | None = None,
        view: str = "",
        timeout: float = 60,
    ) -> subprocess.CompletedProcess[str]:
        """The same to its end."""
        process = self.start(*arguments, environ=environ, view=view)
        try:
            output, errors = process.communicate(timeout=timeout)
        finally:
            process.kill()
        return subprocess.CompletedProcess(process.args, process.returncode, output, errors)

    def remove(self) -> None:
        """Give back the space, which is much after a set-up; pytest itself keeps folders for a while."""
        shutil.rmtree(self.root)

    def files(self) -> dict[str, float]:
        """Every file and folder with the time of its last change."""
        return {str(path): path.lstat().st_mtime_ns for path in self.root.rglob("*")}
