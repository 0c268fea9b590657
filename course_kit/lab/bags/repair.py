"""Completes a bag whose recorder was killed: the index of its mcap files, and metadata.yaml."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit.base.arguments import PATH, takes
from course_kit.base.atomic_files import reason_of, set_aside
from course_kit.lab.bags import cut_sqlite
from course_kit.lab.bags.files import METADATA, STORAGES, is_being_recorded, opened, storage_files
from course_kit.lab.bags.metadata import VERSION, Span, as_yaml, metadata_of, write_metadata
from course_kit.lab.bags.storage import BagError, open_storage
from course_kit.lab.bags.writer import announce
from course_kit.ros.private_api.rosbags_parts import FILES

if TYPE_CHECKING:
    from rosbags.rosbag2 import Reader


class Completed(NamedTuple):
    """A storage file that had to be completed: its messages, and under which name it is kept if it was cut."""

    message_count: int
    kept: str = ""


@takes(folder=PATH)
def reindex(folder: str | os.PathLike[str]) -> dict[str, Completed]:
    """Complete a bag; return the storage files that had to be completed.

    metadata.yaml is written anew in any case. Raises BagError if that cannot be done.
    """
    place = Path(folder)
    if not place.is_dir():
        raise BagError("Must specify a bag directory")
    if is_being_recorded(place):
        raise BagError(f"'{folder}' is still being recorded")
    files = storage_files(place)
    if not files:
        raise BagError("No storage files found for reindexing. Abort")
    completed = {}
    was_closed = (place / METADATA).exists()
    for file in files:
        try:
            made = _complete(file, was_closed)
        except BagError:
            raise
        except Exception as error:  # a damaged file makes rosbags raise whatever its bytes lead to
            reason = reason_of(error) if isinstance(error, OSError) else error
            raise BagError(f"'{file}' cannot be completed: {reason}") from None
        if made is not None:
            completed[file.name] = made
    with opened(place, by_metadata=False) as bag:
        spans = [_span(file, reader) for file, reader in zip(files, bag.readers, strict=True)]
        try:
            write_metadata(place, metadata_of(STORAGES[files[0].suffix], spans, bag.connections))
        except OSError as error:
            raise BagError(str(error)) from None
    return completed


def _complete(file: Path, was_closed: bool) -> Completed | None:
    """Write a file anew that has no end; None if nothing was to be done. One that was closed is kept: it was cut."""
    reader, is_whole = open_storage(file)
    with contextlib.closing(reader):
        if is_whole:
            return None
        count, cut = reader.message_count, cut_sqlite.is_cut(file)
        if file.suffix != ".mcap" and not cut:  # whole once opening it has undone what was half written
            return Completed(count)
        with tempfile.TemporaryDirectory(dir=file.parent, prefix=".reindex") as folder:
            draft = Path(folder, file.name)
            _copy(reader, draft, STORAGES[file.suffix])
            kept = set_aside(file).name if cut or was_closed else ""
            draft.replace(file)
        return Completed(count, kept)


def _copy(reader: Reader, file: Path, storage: str) -> None:
    """Write what an open storage file holds into a new one."""
    copy = FILES[storage](file)
    try:
        for connection in reader.connections:
            announce(copy, connection)
        for connection, nanoseconds, data in reader.messages():
            copy.write(connection, nanoseconds, data)
        copy.close(VERSION, as_yaml(metadata_of(storage, [_span(file, reader)], reader.connections)))
    except BaseException:
        with contextlib.suppress(Exception):
            copy.abort()
        raise


def _span(file: Path, reader: Reader) -> Span:
    return Span(file.name, reader.start_time, reader.end_time - 1, reader.message_count)
