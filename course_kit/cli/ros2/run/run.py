"""`ros2 run`: an executable of a package, by its name."""

from __future__ import annotations

import contextlib
import shlex
import signal
from argparse import REMAINDER, Namespace
from pathlib import Path

from course_kit.cli.ros2 import children
from course_kit.cli.ros2.completion import of_background, offering, package_names
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import CommandError, Verb, argument, did_you_mean, duration, failing, look_up
from course_kit.ros import packages


def _executables(args: Namespace) -> list[str]:
    with contextlib.suppress(LookupError):
        return [path.name for path in packages.executables(args.package_name)]
    return []


def executable(package: str, name: str) -> Path:
    """The executable of that name in a package. CommandError if there is none, or more than one."""
    found = look_up(packages.executables, package)
    matching = [path for path in found if path.name == name]
    if not matching:
        raise CommandError("No executable found", _hint(package, name, [path.name for path in found]))
    if len(matching) > 1:
        raise CommandError("\n- ".join(["Multiple executables found:", *map(str, matching)]))
    return matching[0]


def _hint(package: str, name: str, names: list[str]) -> str:
    listed = f"{package} has: {', '.join(sorted(names))}" if names else f"{package} has no executables"
    return did_you_mean(name, names) or listed


def _run(args: Namespace, session: Session) -> int:
    with failing(ValueError, say=lambda error: f"--prefix {args.prefix}: {error}"):
        prefix = [] if args.prefix is None else shlex.split(args.prefix)
    cmd = [*prefix, str(executable(args.package_name, args.executable_name)), *args.argv]
    if session.in_notebook or args.duration is not None:
        status = children.run_in_notebook(cmd, session)
    else:
        status = children.run_in_terminal(cmd)
    if status < 0:
        session.print(f"[ros2run]: {signal.strsignal(-status)}")
    elif status > 0:
        session.print(f"[ros2run]: Process exited with failure {status}")
    return status


COMMAND = Verb(
    "start an executable of a package",
    _run,
    argument("--prefix", "words before the executable, in quotes, such as 'gdb -ex run --args'"),
    duration,
    argument("package_name", "the package", package_names),
    argument("executable_name", "the executable", offering(_executables)),
    argument("argv", "arguments of the executable", of_background, nargs=REMAINDER),
)
