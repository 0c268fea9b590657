"""Files are written whole, or not at all."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from course_kit.whole_files import write_whole


def test_an_earlier_file_stays_where_a_new_one_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    file = write_whole(tmp_path / "new" / "a.txt", b"first")

    def fail(*paths: object) -> None:
        raise OSError("the disk is full")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="full"):
        write_whole(file, b"second")
    assert file.read_bytes() == b"first"
    assert [each.name for each in file.parent.iterdir()] == ["a.txt"]


@pytest.mark.parametrize(("mode", "expected"), [(0o666, 0o644), (0o600, 0o600)])
def test_a_file_has_the_rights_of_any_other(tmp_path: Path, mode: int, expected: int):
    before = os.umask(0o022)
    try:
        file = write_whole(tmp_path / "a.txt", b"", mode)
    finally:
        os.umask(before)
    assert stat.S_IMODE(file.stat().st_mode) == expected
