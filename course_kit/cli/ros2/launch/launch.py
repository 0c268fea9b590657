"""`ros2 launch`: a launch file, by its path or by its package and name."""

from __future__ import annotations

import contextlib
import os
import shlex
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any, NoReturn

from course_kit.base.kernel import in_kernel
from course_kit.cli.launching import stand_ins
from course_kit.cli.ros2 import children
from course_kit.cli.ros2.completion import offering
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import (
    CommandError,
    Verb,
    argument,
    compiled,
    did_you_mean,
    duration,
    failing,
    flag,
    look_up,
    one_of,
)
from course_kit.ros import packages

EXTENSIONS = ("launch.py", "launch.xml", "launch.yaml", "launch.yml")


def _offer_packages_and_files(prefix: str, **_: Any) -> list[str]:
    folder = os.path.dirname(prefix)
    entries = os.scandir(folder or ".") if os.path.isdir(folder or ".") else ()
    paths = [
        os.path.join(folder, entry.name) + ("/" if entry.is_dir() else "")
        for entry in entries
        if entry.is_dir() or entry.name.endswith(EXTENSIONS)
    ]
    return [name for name in [*packages.package_names(), *sorted(paths)] if name.startswith(prefix)]


def _launch_files(package: str) -> list[str]:
    """The names of the launch files of a package, sorted; none if there is no such package."""
    return sorted(name for name in map(os.path.basename, _files(_share(package) or "")) if name.endswith(EXTENSIONS))


def _argument_names(args: Namespace) -> list[str]:
    """What the arguments of the launch file begin with; none if it cannot be read. In a kernel none is run."""
    with contextlib.suppress(Exception, SystemExit):
        if not in_kernel():
            path, _ = find_launch_file(args)
            return [f"{one.name}:=" for one in _arguments_of(path)]
    return []


def _arguments_of(path: str) -> list[Any]:
    from course_kit.cli.launching.describing import arguments_of
    from course_kit.cli.launching.include import load_launch_file

    stand_ins.install()
    return list(arguments_of(load_launch_file(path)))


def _run(args: Namespace, session: Session) -> int:
    if session.in_notebook or args.duration is not None:
        # A launch has a loop, signals and an environment of its own, so it is a process of its own.
        return children.run_in_notebook([*children.PROGRAM, *_without_duration(args.words)], session)
    if _is_real():
        _hand_over(args.words)
    path, given = find_launch_file(args)
    values = parse_arguments(given)
    if args.show_all_subprocesses_output:
        os.environ["OVERRIDE_LAUNCH_PROCESS_OUTPUT"] = "both"
    stand_ins.install()
    if args.print or args.show_args:
        _describe(path, args, session)
        return 0
    with failing(ValueError, say=lambda error: f"--launch-prefix {args.launch_prefix}: {error}"):
        shlex.split(args.launch_prefix or "")
    compiled(args.launch_prefix_filter or "")
    if args.launch_prefix is not None:
        values["launch-prefix"] = args.launch_prefix
    if args.launch_prefix_filter is not None:
        if args.launch_prefix is None:
            raise CommandError("--launch-prefix-filter needs a --launch-prefix")
        values["launch-prefix-filter"] = args.launch_prefix_filter
    return _launch(path, values, given, args)


def _without_duration(words: Sequence[str]) -> list[str]:
    parser = ArgumentParser(add_help=False)
    duration(parser)
    return parser.parse_known_args(words)[1]


def _is_real() -> bool:
    """Return True if ROS 2's own `ros2 launch` is installed; then that one runs."""
    spec = find_spec("ros2launch")
    return spec is not None and spec.origin is not None


def _hand_over(words: Sequence[str]) -> NoReturn:
    start = "import sys; from ros2cli.cli import main; sys.exit(main())"
    sys.stdout.flush()
    os.execv(sys.executable, [sys.executable, "-c", start, *words])


def find_launch_file(args: Namespace) -> tuple[str, list[str]]:
    """The launch file that is meant and the arguments for it. CommandError if it is not there."""
    name, file_name, given = args.package_name, args.launch_file_name, args.launch_arguments
    share = _share(name)
    if file_name is None or (share is None and os.path.exists(name)):
        if not os.path.isfile(name):
            raise CommandError("No launch file supplied", _file_hint(name, share is not None))
        return name, [*([] if file_name is None else [file_name]), *given]
    share = look_up(packages.share_directory, name, "Package '{}' not found: {}")
    found = [path for path in _files(share) if os.path.basename(path) == file_name]
    if not found:
        raise CommandError(
            f"file '{file_name}' was not found in the share directory of package '{name}' which is at '{share}'",
            did_you_mean(file_name, _launch_files(name)),
        )
    if len(found) > 1:
        paths = ", ".join(f"'{path}'" for path in found)
        raise CommandError(
            f"file '{file_name}' was found more than once in the share directory of package '{name}': [{paths}]"
        )
    return found[0], given


def _share(name: str) -> str | None:
    with contextlib.suppress(LookupError):
        return packages.share_directory(name)
    return None


def _file_hint(name: str, is_package: bool) -> str | None:
    if is_package:
        return f"{name} has: {', '.join(_launch_files(name))}" if _launch_files(name) else f"{name} has no launch files"
    folder = os.path.dirname(name) or "."
    names = sorted(os.listdir(folder)) if os.path.isdir(folder) else []
    return did_you_mean(os.path.basename(name), [n for n in names if n.endswith((".py", ".xml", ".yaml"))])


def _files(folder: str) -> list[str]:
    return [os.path.join(root, name) for root, _, names in os.walk(folder) for name in names]


def parse_arguments(given: list[str]) -> dict[str, str]:
    """Values by name; of two for the same name the last one. CommandError for what is not name:=value."""
    values: dict[str, str] = {}
    for word in given:
        name, sign, value = word.partition(":=")
        if not sign or not name or not value:
            raise CommandError(f"malformed launch argument '{word}', expected format '<name>:=<value>'")
        values[name] = value
    return values


def _describe(path: str, args: Namespace, session: Session) -> None:
    from course_kit.cli.launching.describing import arguments_text, description_text
    from course_kit.cli.launching.include import load_launch_file

    with failing(Exception, SystemExit):  # whatever the launch file does
        description = load_launch_file(path)
    session.print(description_text(description) if args.print else arguments_text(description))


def _launch(path: str, values: dict[str, str], argv: list[str], args: Namespace) -> int:
    from course_kit.base.shutdown import watchdog
    from course_kit.cli.launching.entities import LaunchDescription
    from course_kit.cli.launching.include import AnyLaunchDescriptionSource, IncludeLaunchDescription
    from course_kit.cli.launching.service import LaunchService

    noninteractive = args.noninteractive or not sys.stdin.isatty()
    service = LaunchService(argv=argv, noninteractive=noninteractive, debug=args.debug)
    include = IncludeLaunchDescription(AnyLaunchDescriptionSource(path), launch_arguments=values.items())
    service.include_launch_description(LaunchDescription([include]))
    try:
        return service.run()
    finally:
        watchdog.end_after_signals(again=True)  # asyncio took the signals, and leaves them to nobody


COMMAND = Verb(
    "start the processes of a launch file",
    _run,
    flag("-n --noninteractive", "there is no terminal: send SIGINT to all processes at the end"),
    flag("-d --debug", "print debug messages of the launch, too"),
    one_of(
        flag("-p --print --print-description", "print the description and start nothing"),
        flag("-s --show-args --show-arguments", "print the arguments of the launch file and start nothing"),
    ),
    flag("-a --show-all-subprocesses-output", "print the output of all processes, whatever the launch file says"),
    argument("--launch-prefix", "words before all commands, in quotes, such as 'xterm -e gdb -ex run --args'"),
    argument("--launch-prefix-filter", "put them only before executables whose name matches this regular expression"),
    duration,
    argument("package_name", "the package of the launch file, or its path", _offer_packages_and_files),
    argument(
        "launch_file_name",
        "the name of the launch file",
        offering(lambda args: _launch_files(args.package_name) or _argument_names(args)),
        nargs="?",
    ),
    argument(
        "launch_arguments",
        "arguments of the launch file, as <name>:=<value>",
        offering(_argument_names),
        nargs="*",
    ),
)
