"""Prints the address of the JupyterLab that a process has started, once it answers.

    python -m course_kit.environment.address 1234

JupyterLab itself hides it among other lines, and its token is known only when it runs.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from urllib.parse import urlsplit

import psutil  # type: ignore[import-untyped]
from jupyter_core.paths import jupyter_runtime_dir

from course_kit.environment.notebook import has_browser
from course_kit.polling import wait_until

TIMEOUT = 60.0
PAUSE = 0.1


def address(process: int, folder: Path, timeout: float = TIMEOUT) -> str | None:
    """The address with its token, or None if the process ended or did not start a server in time."""
    announcement = folder / f"jpserver-{process}.json"
    wait_until(lambda: _announced(process, announcement) or not _runs(process), timeout, PAUSE)
    return _announced(process, announcement)


def _announced(process: int, announcement: Path) -> str | None:
    try:
        server = json.loads(announcement.read_text())
    except (OSError, ValueError):  # not written yet, or half of it
        return None
    if not _listens(process, server["port"]):  # JupyterLab announces itself a moment before
        return None
    token = f"?token={server['token']}" if server["token"] else ""
    return f"{server['url']}lab{token}"


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


if __name__ == "__main__":
    found = address(int(sys.argv[1]), Path(jupyter_runtime_dir()))
    if found:
        print(f"\nJupyterLab runs (Ctrl-C twice ends it). Its address: {found}", flush=True)
        if not has_browser(os.environ):
            port = urlsplit(found).port
            tunnel = f"ssh -L {port}:{urlsplit(found).hostname}:{port} {os.uname().nodename}"
            print(f"For a browser on another machine, run this there first: {tunnel}", flush=True)
