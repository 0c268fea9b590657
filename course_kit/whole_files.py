"""Files that are written whole. Standard library only."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def write_whole(path: Path, content: bytes, mode: int = 0o666) -> Path:
    """Write a file so that whoever reads meanwhile finds all of the old one or all of the new one; return it.

    `mode`: of a new file, less what the umask takes. Raises OSError.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    # Beside it, so that taking its place is one step; in a folder, for the file to get the user's usual rights.
    with tempfile.TemporaryDirectory(prefix=f".{path.name[:40]}-", dir=path.parent) as folder:
        new = Path(folder, "new")
        new.touch(mode)
        new.write_bytes(content)
        os.replace(new, path)
    return path
