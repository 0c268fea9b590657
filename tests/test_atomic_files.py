"""Files are written whole, or not at all; locks are not waited for without end."""

from __future__ import annotations

import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from course_kit.base.atomic_files import NotWritten, set_aside, write_whole
from course_kit.base.file_locks import LockTimeout, locked


def test_an_earlier_file_stays_where_a_new_one_cannot_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    file = write_whole(tmp_path / "new" / "a.txt", b"first")

    def fail(*paths: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(NotWritten) as raised:
        write_whole(file, b"second")
    assert str(raised.value) == (
        f"'{file}' cannot be written: No space left on device. Make room on that disk, or write to another one."
    )
    assert raised.value._render_traceback_() == [str(raised.value)]
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
    file.chmod(0o660)
    assert stat.S_IMODE(write_whole(file, b"again").stat().st_mode) == 0o660, "its own, once it has some"


def test_a_link_stays_one_and_a_device_is_not_replaced(tmp_path: Path):
    file, link = tmp_path / "file", tmp_path / "link"
    file.write_bytes(b"first")
    link.symlink_to(file)
    write_whole(link, b"second")
    assert link.is_symlink() and file.read_bytes() == b"second"
    with pytest.raises(NotWritten, match="'/dev/full' cannot be written: No space left on device"):
        write_whole(Path("/dev/full"), b"text")
    assert Path("/dev/full").is_char_device()


def test_what_a_killed_writer_left_goes_with_the_next_and_that_of_a_living_one_stays(tmp_path: Path):
    file = write_whole(tmp_path / "a[1].txt", b"first")
    stop = "import os, signal, sys\nfrom pathlib import Path\nfrom course_kit.base.atomic_files import write_whole\n"
    stop += "os.replace = lambda *_: os.kill(os.getpid(), signal.SIGSTOP)\nwrite_whole(Path(sys.argv[1]), b'other')"
    with subprocess.Popen([sys.executable, "-c", stop, str(file)]) as writer:
        os.waitid(os.P_PID, writer.pid, os.WSTOPPED)
        write_whole(file, b"second")
        assert len(list(tmp_path.iterdir())) == 2, "one is still being written"
        writer.send_signal(signal.SIGKILL)
    write_whole(file, b"third")
    assert [each.name for each in tmp_path.iterdir()] == [file.name]
    assert file.read_bytes() == b"third"


def test_a_file_is_set_aside_without_replacing_another(tmp_path: Path):
    for number in (1, 2):
        file = write_whole(tmp_path / "a.json", b"%d" % number)
        assert set_aside(file).name == f"a.json.damaged-{number}"
    assert (tmp_path / "a.json.damaged-1").read_bytes() == b"1"


def test_a_lock_that_another_has_is_said_after_its_time(tmp_path: Path):
    with locked(tmp_path / "lock", 1.0):
        began = time.monotonic()
        with (
            pytest.raises(LockTimeout, match=rf"kept the lock '{tmp_path}/lock' for 0\.2 s"),
            locked(tmp_path / "lock", 0.2),
        ):
            pass
        assert 0.2 <= time.monotonic() - began < 5.0
    with locked(tmp_path / "lock", 0.0):
        pass
