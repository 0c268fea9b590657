"""`%ros2 …` in a notebook: the `ros2` command in the kernel, on its running ROS context, with Tab completion."""

from __future__ import annotations

import contextlib
import shlex
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


def load_ipython_extension(shell: InteractiveShell) -> None:
    """Register `%ros2`. The kernels of the course's environment do so by themselves."""
    from IPython.core.magic import MAGIC_NO_VAR_EXPAND_ATTR

    # YAML has braces, which IPython would take for variables of the notebook.
    setattr(ros2, MAGIC_NO_VAR_EXPAND_ATTR, True)
    shell.magics_manager.register_function(ros2, magic_kind="line", magic_name="ros2")
    shell.set_hook("complete_command", _complete, re_key=r"%?ros2")


def ros2(line: str) -> None:
    """Run a `ros2` command line in the kernel: no new process, the answer at once.

    Verbs that go on (echo, hz, bw, pub -r, bag record) write into the cell until it is interrupted, or --duration
    seconds have passed.
    """
    from course_kit.ros2 import command

    try:
        words = shlex.split(line)
    except ValueError as error:
        print(f'ros2: {error}: write YAML in double quotes, and a backslash twice: "{{linear: {{x: 2.0}}}}"')
        return
    with contextlib.suppress(SystemExit):  # argparse has printed the usage or the help
        command.run(words)


def _complete(shell: InteractiveShell, event: Any) -> list[str]:
    """What may follow what is typed after `%ros2`."""
    from course_kit.ros2.line_completion import complete

    _, _, typed = event.text_until_cursor.partition("ros2")
    return [event.symbol + rest for rest in complete(typed.lstrip(" "))]
