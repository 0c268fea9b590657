"""On whom a look at the graph waits, in words."""

from __future__ import annotations

import os
from collections.abc import Container, Iterable
from pathlib import Path

from course_kit.ros.private_api.fastdds_parts import PROCESSES, Origin, processes_listening

LONGEST = 60  # characters of a command line


def waited_for(domain: int, known: Iterable[bytes], announced: Container[bytes]) -> str:
    """Which processes of this machine are known to be in the domain and have not named their nodes, in a sentence.

    `known` are the ids of the participants that were found, `announced` those that have named them.
    """
    origins = {one: Origin.of(one) for one in known}
    done = {origin.pid_bits for one, origin in origins.items() if origin is not None and one in announced}
    silent = [pid for pid in sorted(processes_listening(domain)) if pid & 0xFFFF not in done and pid != os.getpid()]
    if silent:
        return f"Waiting for {' and '.join(map(_described, silent))}: no word yet of which nodes run there"
    if len(done) < len(origins):
        return "Waiting for a process of another user: no word yet of which nodes run there"
    return "Waiting for topics and services of which nodes have told, and which are not found yet"


def _described(pid: int) -> str:
    try:
        words = Path(PROCESSES, str(pid), "cmdline").read_text(errors="replace").split("\0")
    except OSError:
        words = []
    line = " ".join([Path(words[0]).name, *words[1:]]).strip() if words else ""
    shown = line if len(line) <= LONGEST else f"{line[: LONGEST - 3]}..."
    return f"process {pid} ({shown})" if shown else f"process {pid}"
