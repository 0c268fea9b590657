"""Commands as users without any rights, who see Python and the course also where they lie in root's home."""

from __future__ import annotations

import contextlib
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]


def command_of(user: int, folder: Path, *command: str, environment: Mapping[str, str] | None = None) -> list[str]:
    """A command line for root that runs a command as this user, in a folder that the user may read."""
    steps, stashed = ["set -e"], dict[Path, Path]()
    for number, place in enumerate({Path(sys.base_prefix), ROOT}):
        hidden = next((p for p in reversed(place.parents) if not p.stat().st_mode & 0o001), None)
        if hidden is not None:
            stashed[place] = folder / f"stashed-{number}"
            steps += [f"mkdir -p {stashed[place]}", f"mount --bind {place} {stashed[place]}"]
            steps += [f"mountpoint -q {hidden} || mount -t tmpfs -o mode=755 tmpfs {hidden}"]
    steps += [f"mkdir -p {place}; mount --bind {kept} {place}" for place, kept in stashed.items()]
    environ = {"HOME": f"{folder}/home", "PATH": f"{sys.prefix}/bin:/usr/bin:/bin", "LANG": "C.UTF-8", "TMPDIR": "/tmp"}
    as_user = ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups", "--no-new-privs"]
    words = [*as_user, "env", "-i", *(f"{k}={v}" for k, v in {**environ, **(environment or {})}.items()), *command]
    # In a mount namespace of its own, so that nothing is changed for anybody else.
    return ["unshare", "-m", "sh", "-c", "\n".join([*steps, f"cd {folder}", f"exec {shlex.join(words)}"])]


class Machine:
    """A shared memory and a loopback interface that no other process of this machine has."""

    def __init__(self, process: int) -> None:
        self.prefix = ["nsenter", f"--target={process}", "--mount", "--net"]  # of a command line that runs there
        self.shared_memory = Path(f"/proc/{process}/root/dev/shm")


@contextlib.contextmanager
def another_machine() -> Iterator[Machine]:
    """A machine without any process, until the block ends."""
    steps = ["set -e", "mount -t tmpfs -o mode=1777 tmpfs /dev/shm", "ip link set lo up", "echo ready", "read end"]
    command = ["unshare", "-m", "-n", "sh", "-c", "\n".join(steps)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        yield Machine(process.pid)
        process.communicate("end\n", timeout=20)
