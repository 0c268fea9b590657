"""Completes a bag whose recorder was killed: the index of its mcap files, and metadata.yaml."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.bags.files import METADATA, STORAGES, is_being_recorded, opened, storage_files
from course_kit.bags.metadata import VERSION, Span, as_yaml, metadata_of, write_metadata
from course_kit.bags.storage import BagError, open_storage
from course_kit.bags.writer import announce
from course_kit.internals.rosbags_parts import McapFile

if TYPE_CHECKING:
    from rosbags.rosbag2 import Reader


def reindex(folder: str | os.PathLike[str]) -> dict[str, int]:
    """Complete a bag; return the storage files that had to be completed, with their number of messages.

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
    for file in files:
        try:
            count = _complete(file)
        except BagError:
            raise
        except Exception as error:  # a damaged file makes rosbags raise whatever its bytes lead to
            raise BagError(f"'{file}' cannot be completed: {getattr(error, 'strerror', '') or error}") from None
        if count is not None:
            completed[file.name] = count
    with contextlib.suppress(FileNotFoundError):
        (place / METADATA).unlink()  # so that the files themselves are asked
    with opened(place) as bag:
        spans = [_span(file, reader) for file, reader in zip(files, bag.readers, strict=True)]
        write_metadata(place, metadata_of(STORAGES[files[0].suffix], spans, bag.connections))
    return completed


def _complete(file: Path) -> int | None:
    """Write an mcap file anew that has no index; return its number of messages, None if nothing was to be done."""
    reader, was_closed = open_storage(file)
    with contextlib.closing(reader):
        if was_closed:
            return None
        count = reader.message_count
        if file.suffix == ".mcap":  # an sqlite3 file is whole once opening it has undone what was half written
            with tempfile.TemporaryDirectory(dir=file.parent, prefix=".reindex") as folder:
                draft = Path(folder, file.name)
                _copy(reader, draft)
                draft.replace(file)
        return count


def _copy(reader: Reader, file: Path) -> None:
    """Write what an open storage file holds into a new mcap file."""
    copy = McapFile(file)
    try:
        for connection in reader.connections:
            announce(copy, connection)
        for connection, nanoseconds, data in reader.messages():
            copy.write(connection, nanoseconds, data)
        copy.close(VERSION, as_yaml(metadata_of("mcap", [_span(file, reader)], reader.connections)))
    except BaseException:
        with contextlib.suppress(Exception):
            copy.abort()
        raise


def _span(file: Path, reader: Reader) -> Span:
    return Span(file.name, reader.start_time, reader.end_time - 1, reader.message_count)
