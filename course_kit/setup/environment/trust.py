"""Signs the notebooks that are as the course has them, so that JupyterLab shows what was stored in them as it was.

JupyterLab leaves scripts, styles and widgets out of outputs that nobody on this machine has vouched for. What a student
then runs and saves it signs itself; what was changed elsewhere stays untrusted until it is run.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import logging
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path

import nbformat
from jupyter_core.paths import jupyter_data_dir
from nbformat.sign import NotebookNotary

from course_kit.setup.environment.stamp import ROOT

MANIFEST = "manifest.json"  # of the students' edition
GIT_TIMEOUT = 10.0


def sign(folder: Path, root: Path = ROOT, data: Path | None = None) -> list[str]:
    """Sign what lies in a folder and is as the course in `root` was released or committed; return the names.

    `data`: the folder where Jupyter keeps its signatures, if not the user's. Raises OSError if it cannot be written.
    """
    known, signed, data = _digests(root), [], data or Path(jupyter_data_dir())
    data.mkdir(mode=0o700, parents=True, exist_ok=True)
    with NotebookNotary(data_dir=str(data), log=_silent()) as notary:
        for path in sorted(folder.glob("*.ipynb")):
            content = path.read_bytes()
            if known.get(path.name) in _possible(content):
                notebook = nbformat.reads(content.decode(), as_version=4)
                if not notary.check_signature(notebook):
                    notary.sign(notebook)
                signed.append(path.name)
    return signed


def _digests(root: Path) -> Mapping[str, str]:
    """The digests of the course's notebooks, by name: of a release from its manifest, of a clone from git."""
    with contextlib.suppress(OSError, ValueError, LookupError, TypeError):
        files = json.loads((root / MANIFEST).read_text())["files"]
        return _by_name((path, str(digest)) for path, digest in files.items())
    command = ["git", "--no-optional-locks", "ls-tree", "HEAD", "notebooks/"]
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        listed = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=GIT_TIMEOUT, check=True)
        about = (line.split("\t", 1) for line in listed.stdout.splitlines())
        return _by_name((path, entry.split()[2]) for entry, path in about)
    return {}


def _by_name(digests: Iterable[tuple[str, str]]) -> dict[str, str]:
    return {Path(path).name: digest for path, digest in digests if Path(path).parent == Path("notebooks")}


def _possible(content: bytes) -> set[str]:
    """What a release's manifest calls this content, and what git does."""
    blob = b"blob %d\0" % len(content) + content
    return {hashlib.sha256(content).hexdigest(), hashlib.sha1(blob).hexdigest(), hashlib.sha256(blob).hexdigest()}


def _silent() -> logging.Logger:
    """A store that cannot be written keeps signatures in memory, and says so at length: trust is then not kept."""
    log = logging.getLogger(__name__)
    log.addHandler(logging.NullHandler())
    log.propagate = False
    return log
