"""How a measured program talks to the benchmark: reports as JSON lines, the end of its input means stop."""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Callable
from typing import Any


def report(**values: Any) -> None:
    """Print one report."""
    print(json.dumps(values), flush=True)


def at_end_of_input(stop: Callable[[], Any]) -> None:
    """Have `stop` called when the benchmark closes this program's input."""

    def wait() -> None:
        sys.stdin.read()
        stop()

    threading.Thread(target=wait, daemon=True).start()
