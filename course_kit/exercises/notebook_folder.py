"""The folder of a chapter's notebook, and the name of the workspace in it."""

from __future__ import annotations

from pathlib import Path

WORKSPACE = "ros2_ws"


def beside_the_notebook(folder: Path) -> Path:
    """Return the notebook's folder, where `folder` is that of its kernel: a %cd may have gone into the workspace."""
    inside = folder.parts.index(WORKSPACE) if WORKSPACE in folder.parts else len(folder.parts)
    return Path(*folder.parts[:inside])
