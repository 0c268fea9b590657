"""Shows a node that is the result of a cell, as run() returns one: its name, and if it runs."""

from __future__ import annotations

from typing import Any

from course_kit.lab.background import running


def attach(shell: Any) -> None:
    """Have the shell show nodes so, also inside lists."""
    shell.display_formatter.formatters["text/plain"].for_type_by_name("rclpy.node", "Node", _write)


def _write(node: Any, printer: Any, _is_cycle: bool) -> None:
    try:
        name = node.get_fully_qualified_name()
    except Exception:  # it was never made, or is destroyed
        printer.text(f"a {type(node).__name__} node that is not there any more")
        return
    where = "in the background" if node in running.nodes() else "which nothing runs yet: run() does"
    printer.text(f"{name}, a {type(node).__name__} node {where}")
