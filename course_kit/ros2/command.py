"""The `ros2` command line: finds the command and its verb, loads no other, and turns failures into exit statuses."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
import signal
import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from collections.abc import Mapping, Sequence
from types import FrameType, ModuleType
from typing import NoReturn

from course_kit.ending.exit_timer import ExitTimer
from course_kit.ros2.session import DurationOver, Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag

COMMANDS = {
    "action": "Various action related sub-commands",
    "bag": "Various rosbag related sub-commands",
    "doctor": "Check ROS setup and other potential issues",
    "interface": "Show information about ROS interfaces",
    "launch": "Run a launch file",
    "node": "Various node related sub-commands",
    "param": "Various param related sub-commands",
    "pkg": "Various package related sub-commands",
    "run": "Run a package specific executable",
    "service": "Various service related sub-commands",
    "topic": "Various topic related sub-commands",
    "wtf": "Use `wtf` as alias to `doctor`",
}
_MODULES = {"wtf": "doctor"}
END_TIMEOUT = 3.0  # seconds for leaving the graph
DESCRIPTION = "ros2 is an extensible command-line tool for ROS 2."


def parser_for(words: Sequence[str]) -> ArgumentParser:
    """The parser of a command line: complete for the command and the verb that it names, a line for each other."""
    parser = ArgumentParser(prog="ros2", description=DESCRIPTION, formatter_class=RawDescriptionHelpFormatter)
    add_flag(
        parser,
        "--use-python-default-buffering",
        "Do not force line buffering in stdout and instead use the python default buffering, which might be "
        "affected by PYTHONUNBUFFERED/-u and depends on whatever stdout is interactive or not",
    )
    named = [word for word in words if not word.startswith("-")]
    parsers = _subparsers(parser, "ros2", COMMANDS, "command", named)
    if named and named[0] in COMMANDS:
        _fill(parsers[named[0]], named[0], named[1:])
    return parser


def _fill(parser: ArgumentParser, command: str, named: Sequence[str]) -> None:
    """Give a command's parser its arguments, and its verbs if it has any."""
    module = _module(command)
    if hasattr(module, "add_arguments"):
        module.add_arguments(parser)
    verbs: Mapping[str, Verb] = getattr(module, "VERBS", {})
    if hasattr(module, "COMMAND"):
        module.COMMAND.arguments(parser)
        parser.set_defaults(verb=module.COMMAND)
    if verbs:
        summaries = {name: verb.summary for name, verb in verbs.items()}
        parsers = _subparsers(parser, f"ros2 {command}", summaries, "verb", named)
        if named and named[0] in verbs:
            verbs[named[0]].arguments(parsers[named[0]])
            parsers[named[0]].set_defaults(verb=verbs[named[0]])


def _module(command: str) -> ModuleType:
    name = _MODULES.get(command, command)
    return importlib.import_module(f"course_kit.ros2.{name}.{name}")


def _subparsers(
    parser: ArgumentParser, prog: str, summaries: Mapping[str, str], kind: str, named: Sequence[str]
) -> dict[str, ArgumentParser]:
    width = max(map(len, summaries))
    listing = "".join(f"{name:{width}}  {summary}\n" for name, summary in sorted(summaries.items()))
    is_chosen = bool(named) and named[0] in summaries
    group = parser.add_subparsers(
        title="Commands",
        description="" if is_chosen else listing,
        metavar=f"Call `{prog} <command> -h` for more detailed usage.",
        dest=f" {kind}",
    )
    made = {}
    for name, summary in sorted(summaries.items()):
        made[name] = group.add_parser(name, description=summary, formatter_class=RawDescriptionHelpFormatter)
    return made


def run(words: Sequence[str]) -> int:
    """Run a command line; return its exit status. A wrong one exits with usage on stderr (SystemExit 2)."""
    parser = parser_for(words)
    args = parser.parse_args(words)
    verb: Verb | None = getattr(args, "verb", None)
    if verb is None:
        _help_for(parser, words)
        return 0
    session = Session(args)
    try:
        return verb.run(args, session) or 0
    except DurationOver:
        return 0
    except KeyboardInterrupt:
        return int(signal.SIGINT)
    except CommandError as error:
        if str(error):
            session.warn(str(error))
        if error.suggestion:
            session.warn(error.suggestion)
        return error.status


def _help_for(parser: ArgumentParser, words: Sequence[str]) -> None:
    """Print the help of the command that was named without a verb, or of `ros2` itself."""
    for named in (word for word in words if word in COMMANDS):
        groups = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
        parser = next(groups).choices[named]
        break
    parser.print_help()


def main() -> NoReturn:
    """Entry point of the `ros2` program."""
    if "_ARGCOMPLETE" in os.environ:
        importlib.import_module("course_kit.ros2.line_completion").answer_shell()
    words = sys.argv[1:]
    if "--use-python-default-buffering" not in words:
        sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    signal.signal(signal.SIGTERM, _terminate)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # also in a shell's background, where it is ignored
    try:
        status = run(words)
    except BrokenPipeError:  # as in `ros2 topic echo ... | head`
        status = _quiet_stdout()
    except SystemExit as ending:  # the usage was printed, or SIGTERM came
        status = int(ending.code or 0)
    _end(status)


def _terminate(number: int, frame: FrameType | None) -> NoReturn:
    raise SystemExit(128 + number)


def _quiet_stdout() -> int:
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return 1


def _end(status: int) -> NoReturn:
    """Leave the graph, then the process, without waiting for what Python tidies up at its end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second Ctrl-C must not keep the node in the graph
    with contextlib.suppress(BrokenPipeError):
        sys.stdout.flush()
    sys.stderr.flush()
    if "course_kit.spinning.context" in sys.modules:
        ExitTimer(END_TIMEOUT, status)
        sys.modules["course_kit.spinning.context"].stop()
    os._exit(status)


if __name__ == "__main__":
    main()
