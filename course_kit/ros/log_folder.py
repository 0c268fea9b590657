"""The folder in which ROS writes log files."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path


def log_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """Return ROS_LOG_DIR, else $ROS_HOME/log, else ~/.ros/log."""
    folder = environment.get("ROS_LOG_DIR") or os.path.join(environment.get("ROS_HOME") or "~/.ros", "log")
    return Path(os.path.normpath(os.path.expanduser(folder)))
