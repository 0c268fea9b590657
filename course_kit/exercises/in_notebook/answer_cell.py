"""Why the notebook has no class or function of a name though a cell has it: that failed, or has not run."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

from course_kit.base import kernel
from course_kit.ros.causes import with_cause

SESSION = "JPY_SESSION_NAME"  # in the environment of a kernel: the notebook that it runs


def why_missing(name: str) -> str:
    """What keeps the class or function from being there, in a sentence; '' if no cell is known to have it."""
    error = kernel.failure_of(name)
    if error is not None:
        return with_cause(f"Its cell ended with {_written(error)}.", error)
    if keyword := _written_as(name):
        return f"Its cell has not run since this kernel started: run the cell with {keyword} {name}, then this one."
    return ""


def _written(error: BaseException) -> str:
    if isinstance(error, SyntaxError):
        line = f", in line {error.lineno}: `{(error.text or '').strip()}`"
        return f"{type(error).__name__}: {error.msg}{line}"
    return f"{type(error).__name__}: {error}"


def _written_as(name: str) -> str:
    """ "class" or "def" if the notebook, as it was saved last, has a cell with that; else nothing."""
    try:
        cells = json.loads(Path(os.environ[SESSION]).read_text(encoding="utf-8"))["cells"]
        sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    except (KeyError, OSError, ValueError, TypeError):
        return ""
    found = (re.search(rf"^(class|def) {re.escape(name)}\b", source, re.MULTILINE) for source in sources)
    return next((match[1] for match in found if match), "")
