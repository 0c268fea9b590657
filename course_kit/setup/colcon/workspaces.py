"""Workspace: a colcon workspace that is built and used from a notebook.

`workspace.build(...)` is what `colcon build ...` is in a terminal, `workspace.use()` what `source install/setup.bash`
is; `workspace.start(command)` starts a command as a terminal does in which the workspace was sourced.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from course_kit.base.arguments import PATH, TEXT, takes
from course_kit.base.atomic_files import writing
from course_kit.base.long_tasks import LongTask, long_task
from course_kit.base.programs import processes
from course_kit.base.programs.child_process import Process
from course_kit.setup.colcon import sourcing, workspace_import
from course_kit.setup.colcon.colcon_output import Build, queued

# What a workspace has at its top, and reset() removes.
MADE_BY_COLCON = ("build", "install", "log")
PARTS = ("src", *MADE_BY_COLCON)
LEAST_ROOM = 256 * 1024  # bytes; the smallest package takes as many


class BuildError(RuntimeError):
    """A build that failed; its text says which package and why. Notebooks show no traceback for it."""

    def __init__(self, build: Build) -> None:
        super().__init__(build.explanation())
        self.build = build

    def _render_traceback_(self) -> list[str]:
        return str(self).splitlines()


class Workspace:
    """A folder with `src`, and what colcon makes beside it: `build`, `install`, `log`."""

    @takes(folder=PATH)
    def __init__(self, folder: Path | str = "ros2_ws") -> None:
        """`folder` lies beside the notebook, unless it is a whole path. It is made, with `src` in it, if need be."""
        self.folder = Path(folder).absolute()
        self.src = self.folder / "src"
        self.install = self.folder / "install"
        with writing(self.src):
            self.src.mkdir(parents=True, exist_ok=True)

    def __repr__(self) -> str:
        return f"{self.folder}: {', '.join(self.packages) or 'no packages yet'}"

    @property
    def packages(self) -> list[str]:
        """The folders with a package.xml below `src`."""
        return sorted(path.parent.name for path in self.src.rglob("package.xml"))

    @takes(packages=TEXT)
    def reset(self, *packages: str) -> None:
        """Make it a fresh one, with an empty `src`; or only these packages of it, as if they had never been there.

        What was in `src` is kept once, in the folder's name + `_before`. Raises ValueError if there is anything else in
        the folder (then it may not be a workspace), or if a package's name is none; NotWritten on a full disk and such.
        """
        with writing(self.folder):
            self._reset(packages)

    def _reset(self, packages: Sequence[str]) -> None:
        kept = self.folder.with_name(f"{self.folder.name}_before")
        if packages:
            for name in packages:
                self._reset_package(name, kept)
            return
        foreign = sorted(path.name for path in self.folder.iterdir() if path.name not in PARTS)
        if foreign:
            raise ValueError(
                f"{self.folder} has {', '.join(foreign)} in it, which no workspace has: nothing is removed"
            )
        for name in MADE_BY_COLCON:
            shutil.rmtree(self.folder / name, ignore_errors=True)
        if any(self.src.iterdir()):
            shutil.rmtree(kept, ignore_errors=True)
            self.src.rename(kept)
        self.src.mkdir(exist_ok=True)

    def _reset_package(self, name: str, kept: Path) -> None:
        if not re.fullmatch(r"\w[\w-]*", name):
            raise ValueError(f"{name!r} is no name of a package: nothing is removed")
        for made in ("build", "install"):
            shutil.rmtree(self.folder / made / name, ignore_errors=True)
        if (self.src / name).exists():
            kept.mkdir(exist_ok=True)
            shutil.rmtree(kept / name, ignore_errors=True)
            (self.src / name).rename(kept / name)

    @takes(arguments=TEXT)
    def build(self, *arguments: str, check: bool = True) -> Build:
        """Run `colcon build` with these arguments in the workspace; what it says is printed as it comes.

        Of a package that fails, only the lines that matter are shown: BuildError has them, unless `check` is False.
        An interrupt ends the build. Raises NotWritten where the disk is full or the folder read-only.
        """
        self._refuse_without_room()
        build = Build()
        with long_task("colcon build", unit="packages") as task:
            self._run(build, arguments, task)
            build.seconds = task.seconds
        for package in build.failed:
            log = self.folder / "log/latest_build" / package / "stdout_stderr.log"
            if log.is_file() and (said := log.read_text(errors="replace").splitlines()):
                build.read_log(package, said)
        if not build.ok:
            self._refuse_without_room()  # colcon and compilers say it in a hundred lines
            if check:
                raise BuildError(build)
            print(build.explanation())
        elif not build.finished:
            print(f"Nothing was built. Packages in {self.src}: {', '.join(self.packages) or 'none'}.")
        return build

    def _run(self, build: Build, arguments: Sequence[str], task: LongTask) -> None:
        def show(line: str) -> None:
            for shown in build.feed(line):
                print(shown, flush=True)
            if task.total is None and build.under_way:
                task.total = queued(self.folder / "log/latest_build/events.log")
            task.done, task.doing = len(build.finished) + len(build.failed), ", ".join(build.under_way)

        process = processes.run_through(("colcon", "build", *arguments), self.unsourced, self.folder, show)
        build.status = process.wait(processes.KILL_TIMEOUT)

    def _refuse_without_room(self) -> None:
        with writing(self.folder), tempfile.TemporaryFile(dir=self.folder) as file:
            file.write(bytes(LEAST_ROOM))

    @property
    def environment(self) -> dict[str, str]:
        """The environment of a terminal in which `source install/setup.bash` was done, in the workspace."""
        return sourcing.sourced(self.install / "setup.bash", self.unsourced)

    @property
    def changes(self) -> dict[str, list[str]]:
        """What sourcing adds to the environment: for each variable the new entries."""
        return sourcing.added(self.unsourced, self.environment)

    @property
    def unsourced(self) -> dict[str, str]:
        """The environment of a new terminal, in which the workspace is not sourced, whatever this notebook uses."""
        return sourcing.without(processes.without_kernel(os.environ), self.folder)

    def start(self, command: str | Sequence[str], name: str | None = None) -> Process:
        """Start a command as start() does, in the workspace's folder and with the workspace sourced."""
        return processes.start(command, name, self.environment, self.folder)

    def use(self) -> None:
        """Source it for this notebook: its packages can be imported, `%ros2` and start() know them.

        After another build call it again. An interface package that was imported before stays as it was until the
        kernel is restarted; that is said.
        """
        environment = self.environment
        changes = sourcing.added(self.unsourced, environment)
        stale = workspace_import.make_importable(self.folder, changes.get("PYTHONPATH", []))
        for name in changes:
            os.environ[name] = environment[name]
        if stale:
            names = ", ".join(stale)
            print(f"{names} was built again after it was imported. To use the new one, restart the kernel.")
