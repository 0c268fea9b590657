"""Whether this process is a Jupyter kernel, found out without importing Jupyter where none runs."""

from __future__ import annotations

import sys
from typing import Any


def shell() -> Any | None:
    """The IPython shell that runs in this process, or None."""
    ipython = sys.modules.get("IPython")
    return ipython.get_ipython() if ipython is not None else None


def in_kernel() -> bool:
    """Whether cells of a notebook run in this process."""
    return hasattr(shell(), "kernel")


def cell() -> tuple[str, str]:
    """What identifies the cell that runs now, also when it is run again, and this run of it; empty elsewhere."""
    running: Any = shell()
    request = running.get_parent() if in_kernel() else {}
    return str(request.get("metadata", {}).get("cellId", "")), str(request.get("header", {}).get("msg_id", ""))
