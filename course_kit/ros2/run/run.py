"""`ros2 run`: an executable of a package, by its name."""

from __future__ import annotations

import shlex
import signal
from argparse import REMAINDER, ArgumentParser, Namespace
from pathlib import Path

from course_kit.programs import packages
from course_kit.ros2 import children
from course_kit.ros2.completion import offering, package_names
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_duration_argument, add_offered, did_you_mean


def _arguments(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--prefix",
        help="Prefix command, which should go before the executable. Command must be wrapped in quotes if it "
        "contains spaces (e.g. --prefix 'gdb -ex run --args').",
    )
    add_duration_argument(parser)
    add_offered(parser, "package_name", package_names, "Name of the ROS package")
    add_offered(parser, "executable_name", offering(_executables), "Name of the executable")
    parser.add_argument("argv", nargs=REMAINDER, help="Pass arbitrary arguments to the executable")


def _executables(args: Namespace) -> list[str]:
    try:
        return [path.name for path in packages.executables(args.package_name)]
    except LookupError:
        return []


def executable(package: str, name: str) -> Path:
    """The executable of that name in a package. CommandError if there is none, or more than one."""
    try:
        found = packages.executables(package)
    except LookupError:
        hint = did_you_mean(package, packages.package_names())
        raise CommandError(f"Package '{package}' not found", hint) from None
    matching = [path for path in found if path.name == name]
    if not matching:
        raise CommandError("No executable found", _hint(package, name, [path.name for path in found]))
    if len(matching) > 1:
        raise CommandError("\n- ".join(["Multiple executables found:", *map(str, matching)]))
    return matching[0]


def _hint(package: str, name: str, names: list[str]) -> str:
    near = did_you_mean(name, names)
    if near:
        return near
    if names:
        return f"{package} has: {', '.join(sorted(names))}"
    return f"{package} has no executables"


def _run(args: Namespace, session: Session) -> int:
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


COMMAND = Verb("Run a package specific executable", _run, _arguments)
