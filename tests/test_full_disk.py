"""A disk that is full and a folder that is read-only: one clear line for each thing that the course writes.

All of them are tried by tests/programs/writes_all.py, on a small file system of its own.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.programs.writes_all import THINGS

ROOT = Path(__file__).parents[1]
pytestmark = [
    pytest.mark.skipif(os.getuid() != 0, reason="only root can mount a small disk"),
    pytest.mark.timeout(240),
]
# How a disk becomes one that nothing can be written to, and what is said.
FULL = "No space left on device. Make room on that disk, or write to another one."
PLACES = {
    "full": ("dd if=/dev/zero of=fill bs=1k", FULL),
    "without inodes": ("n=0; while touch fill$n; do n=$((n+1)); done", FULL),
    "read-only": ("mount -o remount,ro .", "Read-only file system. Choose a folder that can be written to."),
}
# Whose folders can be made on a full disk, and hold nothing yet.
ROOM_ENOUGH = {("full", "workspace")}


@pytest.fixture(scope="module", params=PLACES)
def place(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Mapping[str, str]]:
    """A place, and what each thing says there."""
    folder = tmp_path_factory.mktemp("disk")
    tried = f"{sys.executable} -m tests.programs.writes_all"
    listed = "find . -type f -not -name 'fill*' -exec sha256sum {} + | sort -k 2; echo --"
    script = f"""
        mount -t tmpfs -o size=400k,nr_inodes=60 tmpfs {folder} && cd {folder} && {tried} prepare && {listed}
        ({PLACES[request.param][0]}) >/dev/null 2>&1
        {tried} && echo && echo -- && {listed}
    """
    environment = os.environ | {"PYTHONPATH": str(ROOT), "XDG_STATE_HOME": f"{folder}/state"}
    # In a mount namespace of its own, so that the disk ends with it.
    command = ["unshare", "--mount", "sh", "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, timeout=220, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    before, said, after, _ = done.stdout.split("--\n")
    return request.param, {"before": before, "after": after, **json.loads(said)}


@pytest.mark.parametrize("thing", THINGS)
def test_one_line_says_what_cannot_be_written_why_and_what_to_do(
    place: tuple[str, Mapping[str, str]], thing: str
) -> None:
    where, said = place
    if (where, thing) in ROOM_ENOUGH:
        assert said[thing] == ""
        return
    lines = [line for line in said[thing].splitlines() if PLACES[where][1] in line]
    assert len(lines) == 1, said[thing]
    assert lines == said[thing].splitlines()[-1:] and "Traceback" not in said[thing]
    assert "None" not in lines[0] and "Errno" not in lines[0]


def test_what_was_there_stays_and_nothing_half_is_left(place: tuple[str, Mapping[str, str]]) -> None:
    _, said = place
    # Locks are empty files, which stay.
    empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
    assert [line for line in said["after"].splitlines() if empty not in line] == said["before"].splitlines()
