"""What is handed in, in folders and zips made for a test."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path

from course_kit.classroom.collect.handins import HandIn, find

NAMES = ("01_setup_checks.ipynb", "02_workspace.ipynb", "03_topics.ipynb", "10_more.ipynb")
TOPICS = "03_topics.ipynb"
MOODLE = "_assignsubmission_file_"


def lay(folder: Path, files: Mapping[str, bytes | str]) -> Path:
    """Put files into a folder, all of one age."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        os.utime(path, (1_000_000_000, 1_000_000_000))
    return folder


def zipped(files: Mapping[str, bytes | str], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", method) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, compress_type=method)
    return data.getvalue()


def topics(hand_ins: list[HandIn]) -> dict[str, str]:
    """Who handed in which 03_topics.ipynb."""
    return {each.student: each.notebooks[TOPICS].decode() for each in hand_ins if TOPICS in each.notebooks}


def in_folder_and_zip(tmp_path: Path, files: Mapping[str, bytes | str]) -> list[list[HandIn]]:
    """What is found in a folder of these files and in a zip of them."""
    (tmp_path / "hw.zip").write_bytes(zipped(files))
    return [find(lay(tmp_path / "hw", files), NAMES), find(tmp_path / "hw.zip", NAMES)]
