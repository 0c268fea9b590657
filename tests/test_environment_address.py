"""The line that tells where JupyterLab runs."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit.setup.environment import address as module
from course_kit.setup.environment.checks.notebook import START


def address(process: int, folder: Path, timeout: float = 60.0) -> str | None:
    """Where the server of a process is, if it is announced in a folder and answers."""
    found = module.server(process, folder, timeout)
    return module.address(found) if found else None


@pytest.fixture
def bound() -> Iterator[socket.socket]:
    """A socket of this process, which stands for the server; nothing listens at it yet."""
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        yield server


def announce(server: socket.socket, folder: Path) -> str:
    """Write what a JupyterLab of this process writes; returns the address that is wanted."""
    port = server.getsockname()[1]
    announcement = {"url": f"http://127.0.0.1:{port}/", "port": port, "token": "0123abcd", "root_dir": str(folder)}
    (folder / f"jpserver-{os.getpid()}.json").write_text(json.dumps(announcement))
    return f"http://127.0.0.1:{port}/lab?token=0123abcd"


def test_the_address_of_a_running_server_has_its_token(tmp_path, bound):
    bound.listen()
    assert address(os.getpid(), tmp_path, timeout=0.05) is None
    wanted = announce(bound, tmp_path)
    assert address(os.getpid(), tmp_path) == wanted


def test_the_address_is_that_of_the_start_page_where_there_is_one(tmp_path, bound):
    bound.listen()
    wanted = announce(bound, tmp_path).replace("/lab?", f"/lab/tree/{START}?")
    (tmp_path / START).touch()
    assert address(os.getpid(), tmp_path) == wanted


def test_it_waits_until_the_server_has_announced_itself(tmp_path, bound):
    bound.listen()
    (tmp_path / f"jpserver-{os.getpid()}.json").write_text("")  # opened, nothing in it yet
    threading.Timer(0.3, announce, [bound, tmp_path]).start()
    found = address(os.getpid(), tmp_path, timeout=10)
    assert found == announce(bound, tmp_path)


def test_a_server_that_has_announced_itself_and_does_not_listen_yet_is_waited_for(tmp_path, bound):
    """JupyterLab writes first and listens then; who opened the address in between was refused."""
    wanted = announce(bound, tmp_path)
    assert address(os.getpid(), tmp_path, timeout=0.2) is None
    threading.Timer(0.3, bound.listen).start()
    assert address(os.getpid(), tmp_path, timeout=10) == wanted
    socket.create_connection(bound.getsockname(), timeout=1).close()


def test_a_server_that_ends_without_announcing_itself_is_not_waited_for(tmp_path):
    begun = time.monotonic()
    with subprocess.Popen(["true"]) as ended:
        os.waitid(os.P_PID, ended.pid, os.WEXITED | os.WNOWAIT)  # ended, and nobody has waited for it
        assert address(ended.pid, tmp_path, timeout=30) is None
    assert time.monotonic() - begun < 10


def test_nothing_is_waited_for_without_end(tmp_path):
    assert address(os.getpid(), tmp_path, timeout=0.2) is None
