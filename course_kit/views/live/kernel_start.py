"""Prepares a kernel at its start: rclpy is made safe, errors say their cause, nodes have consoles, waits a bar."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from course_kit.base import kernel
from course_kit.cli.ros2 import magic
from course_kit.lab.background import guards
from course_kit.ros import private_api as internals
from course_kit.ros.private_api.inspect_parts import know_cell
from course_kit.views.live import console, described, node_text, process_console, progress_bar, tabs, tracebacks

if TYPE_CHECKING:
    from course_kit.views.live.view import View


def load_ipython_extension(shell: Any) -> None:
    """Put all of it in place. The kernels of the course's environment do so by themselves."""
    internals.hold()
    shell.events.register("pre_run_cell", lambda _: internals.release())
    shell.events.register("pre_run_cell", lambda cell: know_cell(_path(shell, cell)))
    if said := internals.untried(internals.package_version("rclpy")):
        internals.say(said)
    shell.events.register("post_run_cell", kernel.note_end)
    tracebacks.fold(shell)
    node_text.attach(shell)
    guards.install()
    if hasattr(shell, "kernel"):
        tabs.attach(shell)
        progress_bar.attach()
    described.attach(shell)
    console.attach()
    process_console.attach()
    magic.shown_in_background = _in_background


def _in_background(words: Sequence[str], name: str) -> View:
    """Show a command line of `ros2` in the background."""
    from course_kit.views.live.background_verb import BackgroundVerb  # ipywidgets takes a tenth of a second

    return BackgroundVerb(words, name)


def _path(shell: Any, cell: Any) -> str:
    """The file that the code of a cell is said to be from."""
    return str(shell.compile.get_code_name(cell.raw_cell, cell.raw_cell, shell.execution_count))
