"""Prints the address of the JupyterLab that a process has started, once it answers and trusts the course's notebooks.

    python -m course_kit.setup.environment.address 1234

JupyterLab itself hides it among other lines, and its token is known only when it runs.
"""

from __future__ import annotations

import json
import os
import sqlite3
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import psutil  # type: ignore[import-untyped]
from jupyter_core.paths import jupyter_runtime_dir

from course_kit.base.polling import wait_until
from course_kit.setup.environment.checks.notebook import START, has_browser
from course_kit.setup.environment.trust import sign

TIMEOUT = 60.0
PAUSE = 0.1


def server(process: int, folder: Path, timeout: float = TIMEOUT) -> dict[str, Any] | None:
    """What Jupyter announces about a server that answers, or None if it ended or did not start in time."""
    announcement = folder / f"jpserver-{process}.json"
    wait_until(lambda: _announced(process, announcement) or not _runs(process), timeout, PAUSE)
    return _announced(process, announcement)


def address(server: Mapping[str, Any]) -> str:
    """Its address with its token: of the course's start page, where the server has it."""
    token = f"?token={server['token']}" if server["token"] else ""
    page = f"/tree/{START}" if Path(server["root_dir"], START).is_file() else ""
    return f"{server['url']}lab{page}{token}"


def _announced(process: int, announcement: Path) -> dict[str, Any] | None:
    try:
        server: dict[str, Any] = json.loads(announcement.read_text())
    except (OSError, ValueError):  # not written yet, or half of it
        return None
    return server if _listens(process, server["port"]) else None  # JupyterLab announces itself a moment before


def _runs(process: int) -> bool:
    try:  # a process that has ended and that nobody has waited for keeps its folder in /proc, but not this link
        os.readlink(f"/proc/{process}/exe")
    except OSError:
        return False
    return True


def _listens(process: int, port: int) -> bool:
    try:
        connections = psutil.Process(process).net_connections("tcp")
    except psutil.Error:  # it has ended
        return False
    return any(each.status == psutil.CONN_LISTEN and each.laddr.port == port for each in connections)


def main() -> None:
    """Wait for the server, have it trust what is the course's own, and say where it is."""
    found = server(int(sys.argv[1]), Path(jupyter_runtime_dir()))
    if not found:
        return
    try:
        sign(Path(found["root_dir"]))
    except (OSError, ValueError, sqlite3.Error) as error:
        print(f"\nThe notebooks' outputs show without scripts and widgets until you run them: {error}", flush=True)
    place = address(found)
    print(f"\nJupyterLab runs (Ctrl-C twice ends it). Its address: {place}", flush=True)
    if not has_browser(os.environ):
        port = urlsplit(place).port
        tunnel = f"ssh -L {port}:{urlsplit(place).hostname}:{port} {os.uname().nodename}"
        print(f"For a browser on another machine, run this there first: {tunnel}", flush=True)


if __name__ == "__main__":
    main()
