"""Finds the Jupyter kernel of this process, and what its cells did; imports no Jupyter where none runs."""

from __future__ import annotations

import re
import sys
from typing import Any


def shell() -> Any | None:
    """The IPython shell that runs in this process, or None."""
    ipython = sys.modules.get("IPython")
    return ipython.get_ipython() if ipython is not None else None


def in_kernel() -> bool:
    """Return True if cells of a notebook run in this process."""
    return hasattr(shell(), "kernel")


def cell() -> tuple[str, str]:
    """What identifies the cell that runs now, also when it is run again, and this run of it; empty elsewhere."""
    running: Any = shell()
    request = running.get_parent() if in_kernel() else {}
    return str(request.get("metadata", {}).get("cellId", "")), str(request.get("header", {}).get("msg_id", ""))


_failures: dict[str, BaseException] = {}  # by the class that a cell was to define


def note_end(result: Any) -> None:
    """Note how a cell ended, by the classes that stand in it."""
    error = result.error_before_exec or result.error_in_exec
    for name in re.findall(r"^class (\w+)", result.info.raw_cell or "", re.MULTILINE):
        _failures.pop(name, None)
        if error is not None:
            _failures[name] = error


def failure_of(class_name: str) -> BaseException | None:
    """The error with which the cell ended last that has the class of this name; None if it did not."""
    return _failures.get(class_name)
