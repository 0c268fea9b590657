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


def request() -> dict[str, Any]:
    """The request to run the present cell, as Jupyter's messages have it; empty outside of a kernel."""
    running: Any = shell()
    return running.get_parent() if in_kernel() else {}
