"""Files that are written whole, or not at all, and what is said where they cannot be. Standard library only."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import glob
import itertools
import os
import secrets
from collections.abc import Iterator
from functools import partial
from pathlib import Path

FULL = "Make room on that disk, or write to another one."
CURES = {
    errno.ENOSPC: FULL,
    errno.EDQUOT: FULL,
    errno.EROFS: "Choose a folder that can be written to.",
    errno.EACCES: "Choose a folder that you may write to, or have its owner let you.",
    errno.EPERM: "Choose a folder that you may write to, or have its owner let you.",
}


class NotWritten(OSError):  # noqa: N818  (reads as what happened)
    """A file or folder could not be written; its text says in one line which, why, and what to do."""

    def __init__(self, error: OSError, path: str | os.PathLike[str]) -> None:
        super().__init__(error.errno, error.strerror or str(error), os.fspath(path))

    def __str__(self) -> str:
        return f"'{self.filename}' cannot be written: {reason_of(self)}"

    def _render_traceback_(self) -> list[str]:
        """What a notebook shows: a full disk is no error of the program's."""
        return [str(self)]


def reason_of(error: OSError) -> str:
    """Why something cannot be written, and what to do where that is known."""
    cure = CURES.get(error.errno or 0)
    return f"{error.strerror}. {cure}" if cure else error.strerror or str(error)


@contextlib.contextmanager
def writing(path: str | os.PathLike[str]) -> Iterator[None]:
    """Raise what goes wrong in the block as NotWritten, which names what the user wants written."""
    try:
        yield
    except OSError as error:
        raise NotWritten(error, path) from None


def write_whole(path: Path, content: bytes, mode: int = 0o666) -> Path:
    """Write a file so that whoever reads meanwhile finds all of the old one or all of the new one; return it.

    `mode`: of a new file, less what the umask takes. A link stays one; a device gets the bytes. Raises NotWritten.
    """
    with writing(path):
        place = Path(os.path.realpath(path))
        if place.exists() and not place.is_file():
            place.write_bytes(content)
            return path
        place.parent.mkdir(parents=True, exist_ok=True)
        if is_there := place.exists():
            with place.open("ab"):  # one that may not be written to is not replaced either
                mode = place.stat().st_mode & 0o7777
        _remove_left(place)
        new = _draft(place, secrets.token_hex(4))
        try:
            with open(new, "xb", opener=partial(os.open, mode=mode)) as file:
                with contextlib.suppress(OSError):  # some network disks have no locks
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # as long as its writer lives
                if is_there:
                    os.fchmod(file.fileno(), mode)
                file.write(content)
                file.flush()
                os.fsync(file.fileno())  # some disks say only now that they are full
                os.replace(new, place)
        except BaseException:
            new.unlink(missing_ok=True)
            raise
    return path


def set_aside(file: Path) -> Path:
    """Give a damaged file a name of its own, which is returned: whoever knows how may mend it. Raises NotWritten."""
    names = (file.with_name(f"{file.name}.damaged-{number}") for number in itertools.count(1))
    with writing(file):
        return file.rename(next(name for name in names if not os.path.lexists(name)))


def _draft(place: Path, key: str) -> Path:
    """The name of a file until it is whole; beside it, so that taking its place is one step."""
    return place.with_name(f".{place.name[:40]}-{key}.new")


def _remove_left(place: Path) -> None:
    """Remove what writers of this file have left that were killed: their locks have ended."""
    for left in place.parent.glob(_draft(Path(glob.escape(place.name[:40])), "*").name):
        with contextlib.suppress(OSError), left.open("rb") as file:
            if os.fstat(file.fileno()).st_size:  # an empty one may be about to be locked
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                left.unlink()
