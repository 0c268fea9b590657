"""What a kernel has from its start: rclpy calls that are safe in a notebook, a console for each node and process."""

from __future__ import annotations

from typing import Any

from course_kit.background import guards
from course_kit.live import console, process_console


def load_ipython_extension(shell: Any) -> None:
    """Put all of it in place. The kernels of the course's environment do so by themselves."""
    guards.install()
    console.attach()
    process_console.attach()
