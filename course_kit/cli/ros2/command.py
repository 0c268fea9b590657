"""The `ros2` command line: finds the command and its verb, loads no other, and turns failures into exit statuses."""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Mapping, Sequence
from types import FrameType
from typing import Any, NoReturn

from course_kit.base.kernel import in_kernel
from course_kit.base.long_tasks import long_task
from course_kit.base.shutdown import watchdog
from course_kit.base.shutdown.signals import asking_to_end, leave_closed_terminal, write_nowhere
from course_kit.cli.ros2.examples import example
from course_kit.cli.ros2.refused import refusal
from course_kit.cli.ros2.session import DurationOver, Session
from course_kit.cli.ros2.verbs import BACKGROUND, CommandError, Verb, background, cut, flag, was_interrupt
from course_kit.ros.private_api.import_parts import import_less

COMMANDS = {
    "action": "send goals, and see who offers actions",
    "bag": "record topics into bags, look into them, play them",
    "daemon": "for scripts that start one: none is needed here",
    "doctor": "check this machine, the packages and the graph",
    "interface": "show the types of messages, services and actions",
    "launch": "start what a launch file describes",
    "lifecycle": "see and change the states of lifecycle nodes",
    "node": "list nodes, and what each is connected to",
    "param": "read and set the parameters of nodes",
    "pkg": "create packages, and find those that are there",
    "run": "start an executable of a package",
    "service": "call services, and see who offers them",
    "topic": "see, measure and publish messages",
    "wtf": "the same as doctor",
}
_MODULES = {"wtf": "doctor"}
DESCRIPTION = "What runs on ROS 2 here: look at it, try it, start it."
OF_A_NOTEBOOK = f"\nWith {BACKGROUND} at its end a command goes on in a view of its own, until stop()."


class _Parser(ArgumentParser):
    def __init__(self, *arguments: Any, **settings: Any) -> None:
        super().__init__(*arguments, **settings)
        self.color = False  # argparse of Python 3.14 colours help in a terminal; that of ROS 2 does not

    def error(self, message: str) -> NoReturn:
        super().error(cut(message))


def parser_for(words: Sequence[str]) -> ArgumentParser:
    """The parser of a command line: complete for the command and the verb that it names, a line for each other."""
    description = DESCRIPTION + (OF_A_NOTEBOOK if in_kernel() else "")
    parser = _Parser(prog="ros2", description=description, formatter_class=RawDescriptionHelpFormatter)
    flag("--use-python-default-buffering", "do not flush each line where the output is no terminal")(parser)
    named = [word for word in words if not word.startswith("-")]
    parsers = _subparsers(parser, COMMANDS, named)
    parser.set_defaults(verb=None, named=parser, words=words)
    if named and named[0] in COMMANDS:
        _fill(parsers[named[0]], *named)
    return parser


def _fill(parser: ArgumentParser, command: str, *named: str) -> None:
    """Give a command's parser its arguments, and its verbs if it has any."""
    module = importlib.import_module("course_kit.cli.ros2.{0}.{0}".format(_MODULES.get(command, command)))
    parser.set_defaults(named=parser)
    if hasattr(module, "add_arguments"):
        module.add_arguments(parser)
    verbs: Mapping[str, Verb | str] = getattr(module, "VERBS", {})
    verb: Verb | None = getattr(module, "COMMAND", None)  # of the command itself, without a verb
    wanted = {named[0]} & verbs.keys() if named else set()
    loaded = {name: _loaded(one) for name, one in verbs.items() if not wanted or name in wanted}
    summaries = {name: loaded[name].summary if name in loaded else "" for name in verbs}
    parsers = _subparsers(parser, summaries, named) if verbs else {}
    for name in wanted:
        parser, verb = parsers[name], loaded[name]
    if verb is not None:
        verb.arguments(parser)
        parser.epilog = example(parser.prog.removeprefix("ros2 "))
        background(parser)
        parser.set_defaults(verb=verb)


def _loaded(verb: Verb | str) -> Verb:
    """Return a verb, which may be one of another module: "topic.echo:ECHO"."""
    if isinstance(verb, Verb):
        return verb
    module, _, name = verb.partition(":")
    found: Verb = getattr(importlib.import_module(f"course_kit.cli.ros2.{module}"), name)
    return found


def _subparsers(
    parser: ArgumentParser, summaries: Mapping[str, str], named: Sequence[str]
) -> dict[str, ArgumentParser]:
    width = max(map(len, summaries))
    listing = "".join(f"{name:{width}}  {summary}\n" for name, summary in sorted(summaries.items()))
    group = parser.add_subparsers(
        title="Commands",
        description="" if named and named[0] in summaries else listing,
        metavar=f"`{parser.prog} <command> -h` tells more of each.",
    )
    return {
        name: group.add_parser(name, description=summary, formatter_class=RawDescriptionHelpFormatter)
        for name, summary in sorted(summaries.items())
    }


def run(words: Sequence[str]) -> int:
    """Run a command line; return its exit status. A wrong one exits with usage on stderr (SystemExit 2)."""
    return perform(parsed(words))


def parsed(words: Sequence[str]) -> Namespace:
    """A command line's arguments, its verb, None if it names none, and its words. SystemExit as above."""
    parser = parser_for(words)
    for word in words:
        if "\0" in word or any("\ud800" <= character <= "\udfff" for character in word):
            parser.error(f"{word!a} is no text of ROS, whose names and strings are UTF-8 without NUL")
    if text := refusal(words):
        print(text, file=sys.stderr)
        raise SystemExit(1)
    return parser.parse_args(words)


def perform(args: Namespace) -> int:
    """Do what a command line says; return its exit status."""
    if args.verb is None:
        args.named.print_help()
        return 0
    session = Session(args)
    try:
        with long_task(lambda: f"ros2 {' '.join(args.words)}", getattr(args, "duration", None)):
            if hasattr(args, "spin_time"):  # of all verbs that look at the graph
                session.join()
            return args.verb.run(args, session) or 0
    except DurationOver:
        return 0
    except KeyboardInterrupt:
        return int(signal.SIGINT)
    except CommandError as error:
        if str(error):
            session.warn(cut(str(error)))
        if error.suggestion:
            session.warn(error.suggestion)
        return error.status
    except Exception as error:
        if was_interrupt(error):
            return int(signal.SIGINT)
        raise


def main() -> NoReturn:
    """Entry point of the `ros2` program."""
    import_less()
    if "_ARGCOMPLETE" in os.environ:
        importlib.import_module("course_kit.cli.ros2.completion").join_ahead(os.environ.get("COMP_LINE", ""))
        importlib.import_module("course_kit.cli.ros2.line_completion").answer_shell()
    words = sys.argv[1:]
    if "--use-python-default-buffering" not in words:
        sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    for number in asking_to_end():
        signal.signal(number, _terminate)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # also in a shell's background, where it is ignored
    watchdog.end_after_signals()
    try:
        status = run(words)
    except KeyboardInterrupt:  # before the verb began
        status = int(signal.SIGINT)
    except BrokenPipeError:  # as in `ros2 topic echo ... | head`
        write_nowhere(1)
        status = 1
    except SystemExit as ending:  # the usage was printed, or SIGTERM came
        status = int(ending.code or 0)
    except Exception:
        with contextlib.suppress(OSError):  # its terminal has closed, and that is the exception
            sys.excepthook(*sys.exc_info())
        status = 1
    end(status)


def _terminate(number: int, frame: FrameType | None) -> NoReturn:
    leave_closed_terminal()
    raise SystemExit(128 + number)


def end(status: int) -> NoReturn:
    """Leave the graph, then the process, without waiting for what Python tidies up at its end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second Ctrl-C must not keep the node in the graph
    with contextlib.suppress(OSError):  # its reader, or its terminal, has gone
        sys.stdout.flush()
        sys.stderr.flush()
    if "course_kit.ros.spinning.context" in sys.modules:
        watchdog.end_in(watchdog.END_TIMEOUT, status)
        sys.modules["course_kit.ros.spinning.context"].stop()
    watchdog.end_now(status)


if __name__ == "__main__":
    main()
