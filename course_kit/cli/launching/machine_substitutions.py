"""Substitutions about this machine: commands, programs, files, names that nobody else has."""

from __future__ import annotations

import os
import random
import shlex
import shutil
import socket
import subprocess
from pathlib import Path

from course_kit.cli.launching import output
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.substitutions import Composed, SomeSubstitutions, SubstitutionFailure


class Command(Composed):
    """What a command prints."""

    shown = "Command({command})"

    def __init__(self, command: SomeSubstitutions, *, on_stderr: SomeSubstitutions = "fail") -> None:
        super().__init__(command=command, on_stderr=on_stderr)

    def _text(self, context: LaunchContext, line: str, on_stderr: str) -> str:
        if on_stderr not in ("fail", "ignore", "warn", "capture"):
            raise SubstitutionFailure("on_stderr is fail, ignore, warn or capture")
        merged = subprocess.STDOUT if on_stderr == "capture" else subprocess.PIPE
        try:
            done = subprocess.run(shlex.split(line), stdout=subprocess.PIPE, stderr=merged, text=True)
        except (FileNotFoundError, PermissionError) as error:
            raise SubstitutionFailure(f"`{line}` cannot be run: {error}") from None
        if done.returncode != 0:
            said = f", with {done.stderr}" if done.stderr else ""
            raise SubstitutionFailure(f"`{line}` ended with status {done.returncode}{said}")
        if done.stderr and on_stderr in ("fail", "warn"):
            message = f"`{line}` wrote to stderr: {done.stderr}"
            if on_stderr == "fail":
                raise SubstitutionFailure(message)
            output.get_logger("launch").warning(message)
        return done.stdout


class FindExecutable(Composed):
    """The path of a program on PATH."""

    shown = "FindExec({name})"

    def __init__(self, *, name: SomeSubstitutions) -> None:
        super().__init__(name=name)

    def _text(self, context: LaunchContext, name: str) -> str:
        path = shutil.which(name)
        if path is None:
            raise SubstitutionFailure(f"PATH leads to no executable '{name}'")
        return path


class FileContent(Composed):
    """What a file says."""

    shown = "{type}({path})"

    def __init__(self, path: SomeSubstitutions) -> None:
        super().__init__(path=path)

    def _text(self, context: LaunchContext, path: str) -> str:
        try:
            return Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise SubstitutionFailure(f"cannot read {path}: {error}") from None


class LaunchLogDir(Composed):
    """The folder of this launch's log files."""

    def _text(self, context: LaunchContext) -> str:
        return str(output.launch_folder())


class AnonName(Composed):
    """A name that is used nowhere else; the same one wherever the launch file asks for it."""

    shown = "AnonName({name})"

    def __init__(self, name: SomeSubstitutions) -> None:
        super().__init__(name=name)

    def _text(self, context: LaunchContext, name: str) -> str:
        host = socket.gethostname().replace(".", "_").replace("-", "_").replace(":", "_")
        made = f"{name}_{host}_{os.getpid()}_{random.getrandbits(32)}"
        return str(context.launch_configurations.setdefault(f"anon{name}", made))
