"""What a kernel does at its start: rclpy calls are made safe in a notebook, each node and process gets a console."""

from __future__ import annotations

from typing import Any

from course_kit import internals
from course_kit.background import guards
from course_kit.ending import shared_memory
from course_kit.internals.inspect_parts import know_cell
from course_kit.live import console, process_console


def load_ipython_extension(shell: Any) -> None:
    """Put all of it in place. The kernels of the course's environment do so by themselves."""
    internals.hold()
    shell.events.register("pre_run_cell", lambda _: internals.release())
    shell.events.register("pre_run_cell", lambda cell: know_cell(_path(shell, cell)))
    if said := internals.untried(internals.package_version("rclpy")):
        internals.say(said)
    guards.install()
    console.attach()
    process_console.attach()
    shared_memory.tidy()  # a kernel before this one may have been killed


def _path(shell: Any, cell: Any) -> str:
    """The file that the code of a cell is said to be from."""
    return str(shell.compile.get_code_name(cell.raw_cell, cell.raw_cell, shell.execution_count))
