"""The effect of `source install/setup.bash` on an environment, as data."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Mapping
from pathlib import Path

from course_kit.setup.environment.activation import PATH_VARIABLES, split_paths

TIMEOUT = 60.0
LISTS = (*PATH_VARIABLES, "COLCON_PREFIX_PATH", "PKG_CONFIG_PATH")
OF_THE_SHELL = ("_", "OLDPWD", "PWD", "SHLVL")


def sourced(script: Path, environ: Mapping[str, str]) -> dict[str, str]:
    """The environment after a bash with `environ` has sourced a script. FileNotFoundError if there is none."""
    if not script.is_file():
        raise FileNotFoundError(f"{script} does not exist: it comes with the first successful `colcon build`")
    done = subprocess.run(
        ["bash", "--noprofile", "--norc", "-c", '. "$0" >&2 && env -0', str(script)],
        env=dict(environ),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
    )
    if done.returncode:
        raise RuntimeError(f"sourcing {script} failed: {(done.stderr.strip().splitlines() or ['no message'])[-1]}")
    pairs = (entry.partition("=") for entry in done.stdout.split("\0") if "=" in entry)
    return {name: value for name, _, value in pairs if name not in OF_THE_SHELL}


def added(before: Mapping[str, str], after: Mapping[str, str]) -> dict[str, list[str]]:
    """What sourcing has added: for each variable, the new entries of a list like PATH, else the new value."""
    changes = {}
    for name in sorted(after):
        if after[name] == before.get(name) or name in OF_THE_SHELL:
            continue
        earlier = split_paths(before.get(name, ""))
        changes[name] = [e for e in split_paths(after[name]) if e not in earlier] if name in LISTS else [after[name]]
    return {name: entries for name, entries in changes.items() if entries}


def without(environ: Mapping[str, str], *folders: Path) -> dict[str, str]:
    """An environment without what lies below some folders, as in a terminal where nothing of them was sourced."""
    result = dict(environ)
    for name in LISTS:
        entries = split_paths(environ.get(name, ""))
        kept = [entry for entry in entries if not any(Path(entry).is_relative_to(folder) for folder in folders)]
        if kept:
            result[name] = os.pathsep.join(kept)
        elif entries:
            del result[name]
    return result
