"""Packages that one chapter makes and a later one needs, as that chapter leaves them.

So chapters 4 and 5 run also where chapter 2 was not. tests/test_chapter_packages.py compares them with its cells.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from course_kit.base.atomic_files import write_whole, writing
from course_kit.setup.colcon.workspaces import Workspace

FOLDER = Path(__file__).parent


def provide(workspace: Workspace, package: str) -> None:
    """Have a package of an earlier chapter built in the workspace, and use() the workspace.

    What is built stays as it is, and what is in `src` too: it is built if need be. Otherwise the package is copied to
    `src` first. Raises BuildError if the build fails, NotWritten if it cannot be copied, ValueError for a package that
    no chapter makes.
    """
    known = sorted(path.parent.name for path in FOLDER.glob("*/package.xml"))
    if package not in known:
        raise ValueError(f"no chapter makes the package {package!r}, only {', '.join(known)}")
    source = workspace.src / package
    if not (workspace.install / package).is_dir():
        if not source.is_dir():
            # A package that is there is taken for a whole one.
            with writing(source), tempfile.TemporaryDirectory(prefix=f".{package}-", dir=workspace.folder) as work:
                for file in (file for file in (FOLDER / package).rglob("*") if file.is_file()):
                    write_whole(work / file.relative_to(FOLDER), file.read_bytes())
                Path(work, package).rename(source)
            print(f"{package}, as chapter 2 makes it, is now in {workspace.folder.name}/src.")
        workspace.build("--packages-select", package)
    workspace.use()
