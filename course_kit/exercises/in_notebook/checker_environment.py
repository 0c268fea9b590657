"""Makes the environment of the checker's process: a ROS 2, a domain, a home, and nothing that loads code.

Standard library only. The notebook's own environment is as its cells have left it; what counts is what it began with.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path

from course_kit.setup.environment import user_domain
from course_kit.setup.environment.activation import PATH_VARIABLES, PROFILE_VARIABLES, sourced_ros, split_paths

# Kept if they are there; LC_… too.
PERSONAL = ("HOME", "USER", "LOGNAME", "LANG", "LANGUAGE", "TZ", "TMPDIR")
ROS = (
    "ROS_DISTRO",
    "ROS_VERSION",
    "ROS_PYTHON_VERSION",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_LOCALHOST_ONLY",
    "ROS_STATIC_PEERS",
    "ROS_LOG_DIR",
    "ROS_HOME",
    "RMW_IMPLEMENTATION",
    "CYCLONEDDS_URI",
    *PROFILE_VARIABLES,
)
DOMAIN = "ROS_DOMAIN_ID"
SYSTEM = "/usr/local/bin:/usr/bin:/bin"


def at_start() -> dict[str, str]:
    """The environment with which this process was started; where the machine does not tell, the present one."""
    with contextlib.suppress(OSError):
        entries = os.fsdecode(Path("/proc/self/environ").read_bytes()).split("\0")
        return dict(entry.split("=", 1) for entry in entries if "=" in entry)
    return dict(os.environ)


def of_checker(start: Mapping[str, str], domain: int | None) -> tuple[dict[str, str], list[str]]:
    """The checker's environment, and where it looks for ROS 2's Python modules besides.

    `start` is what the notebook's process was started with, `domain` where its nodes are, if there are any. Of a
    sourced ROS 2 all is kept that lies in its folder. An isolated Python does not heed PYTHONPATH, so that is apart.
    """
    kept = {name: value for name, value in start.items() if name in (*PERSONAL, *ROS, DOMAIN) or name[:3] == "LC_"}
    ros = sourced_ros(start)
    lists = {name: _below(ros.prefix, start.get(name, "")) if ros else [] for name in PATH_VARIABLES}
    paths = lists.pop("PYTHONPATH")
    lists["PATH"] += SYSTEM.split(os.pathsep)
    kept |= {name: os.pathsep.join(entries) for name, entries in lists.items() if entries}
    if domain is not None:
        kept[DOMAIN] = str(domain)
    kept.setdefault(DOMAIN, user_domain.take(os.getuid()))
    return kept, paths


def _below(folder: str, value: str) -> list[str]:
    return [entry for entry in split_paths(value) if Path(entry).is_relative_to(folder)]
