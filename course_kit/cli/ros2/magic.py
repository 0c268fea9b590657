"""`%ros2 …` in a notebook: the `ros2` command in the kernel, on its running ROS context, with Tab completion."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

View = Any  # live/background_verb.py has it
shown_in_background: Callable[[Sequence[str], str], View] | None = None  # starts words, with a name; live/ sets it


def load_ipython_extension(shell: InteractiveShell) -> None:
    """Register `%ros2`. The kernels of the course's environment do so by themselves."""
    from IPython.core.magic import MAGIC_NO_VAR_EXPAND_ATTR

    # YAML has braces, which IPython would take for variables of the notebook.
    setattr(ros2, MAGIC_NO_VAR_EXPAND_ATTR, True)
    shell.magics_manager.register_function(ros2, magic_kind="line", magic_name="ros2")
    shell.set_hook("complete_command", _complete, re_key=r"%?ros2")


def ros2(line: str) -> View | None:
    """Run a `ros2` command line in the kernel: no new process, the answer at once.

    Verbs that go on (echo, hz, bw, pub -r, bag record) write into the cell until it is interrupted, or --duration
    seconds have passed. With --background the cell is done at once: the verb goes on as a process of its own, whose
    state and last lines stand under the cell, until its button, stop(), the cell's next run or the kernel's end.
    `hz = %ros2 topic hz /chatter --background` gives the view: `hz.process`, `hz.stop()`.
    """
    from course_kit.cli.ros2 import command, verbs

    try:
        words = shlex.split(line)
    except ValueError as error:
        print(f'ros2: {error}: write YAML in double quotes, and a backslash twice: "{{linear: {{x: 2.0}}}}"')
        return None
    with contextlib.suppress(SystemExit):  # argparse has printed the usage or the help
        if verbs.BACKGROUND in words:
            return _in_background(words, line)
        command.run(words)
    return None


def _in_background(words: list[str], line: str) -> View | None:
    """Start a command line in the background if it is a right one, and --background no word of a program's own."""
    from course_kit.cli.ros2 import command
    from course_kit.cli.ros2.verbs import BACKGROUND

    at_end = words[-1] == BACKGROUND  # there `run` would take it for a word of the program
    args = command.parsed(words[:-1] if at_end else words)
    if args.verb is None or shown_in_background is None or not (at_end or args.background):
        command.perform(args)
        return None
    before, _, after = (line.rpartition if at_end else line.partition)(BACKGROUND)
    del words[-1 if at_end else words.index(BACKGROUND)]
    try:
        return shown_in_background(words, " ".join(f"ros2 {before} {after}".split()))
    except OSError as error:
        print(f"ros2: {error}")
        return None


def _complete(shell: InteractiveShell, event: Any) -> list[str]:
    """What may follow what is typed after `%ros2`."""
    from course_kit.cli.ros2.line_completion import endings

    _, _, typed = event.text_until_cursor.partition("ros2")
    return [event.symbol + rest for rest in endings(typed.lstrip(" "))]
