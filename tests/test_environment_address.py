"""The line that tells where JupyterLab runs."""

from __future__ import annotations

import json
import os
import subprocess
import threading
import time

from course_kit.environment.address import address

SERVER = {"url": "http://127.0.0.1:8889/", "token": "0123abcd"}


def test_the_address_of_a_running_server_has_its_token(tmp_path):
    (tmp_path / f"jpserver-{os.getpid()}.json").write_text(json.dumps(SERVER))
    assert address(os.getpid(), tmp_path) == "http://127.0.0.1:8889/lab?token=0123abcd"


def test_it_waits_until_the_server_has_announced_itself(tmp_path):
    announcement = tmp_path / f"jpserver-{os.getpid()}.json"
    announcement.write_text("")  # opened, nothing in it yet
    threading.Timer(0.3, announcement.write_text, [json.dumps(SERVER)]).start()
    assert address(os.getpid(), tmp_path, timeout=10) == "http://127.0.0.1:8889/lab?token=0123abcd"


def test_a_server_that_ends_without_announcing_itself_is_not_waited_for(tmp_path):
    begun = time.monotonic()
    with subprocess.Popen(["true"]) as ended:
        os.waitid(os.P_PID, ended.pid, os.WEXITED | os.WNOWAIT)  # ended, and nobody has waited for it
        assert address(ended.pid, tmp_path, timeout=30) is None
    assert time.monotonic() - begun < 10


def test_nothing_is_waited_for_without_end(tmp_path):
    assert address(os.getpid(), tmp_path, timeout=0.2) is None
