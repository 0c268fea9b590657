"""Completes a bag whose recorder was killed: the index of its mcap files, and metadata.yaml."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path
from typing import Any

from course_kit.bags.files import METADATA, is_being_recorded, opened, storage_files
from course_kit.bags.metadata import VERSION, as_yaml, metadata_of, write_metadata
from course_kit.bags.storage import BagError, channel_words, open_storage
from course_kit.bags.writer import McapFile


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
        except OSError as error:
            raise BagError(f"'{file}' cannot be completed: {error.strerror or error}") from None
        if count is not None:
            completed[file.name] = count
    with contextlib.suppress(FileNotFoundError):
        (place / METADATA).unlink()  # so that the files themselves are asked
    with opened(place) as bag:
        spans = [(file.name, reader.metadata) for file, reader in zip(files, bag._readers, strict=True)]
        described = [(name, span.start_time, max(0, span.duration - 1), span.message_count) for name, span in spans]
        topics = [(connection, connection.msgcount) for connection in bag.connections]
        storage = "sqlite3" if files[0].suffix == ".db3" else "mcap"
        write_metadata(place, metadata_of(storage, described, topics))
    return completed


def _complete(file: Path) -> int | None:
    """Write an mcap file anew that has no index; return its number of messages, None if nothing was to be done."""
    reader, was_closed = open_storage(file)
    with contextlib.closing(reader):
        if was_closed:
            return None
        count = int(reader.metadata.message_count)
        if file.suffix == ".mcap":  # an sqlite3 file is whole once opening it has undone what was half written
            with tempfile.TemporaryDirectory(dir=file.parent, prefix=".reindex") as folder:
                draft = Path(folder, file.name)
                _copy(reader, draft)
                draft.replace(file)
        return count


def _copy(reader: Any, file: Path) -> None:
    """Write what an open storage file holds into a new mcap file."""
    copy = McapFile(file)
    try:
        known: set[str] = set()
        for connection in reader.connections:
            if connection.msgtype not in known:
                copy.add_msgtype(connection)
                known.add(connection.msgtype)
            copy.add_connection(connection, channel_words(reader, connection.id).get("offered_qos_profiles", ""))
        for connection, nanoseconds, data in reader.messages(reader.connections):
            copy.write(connection, nanoseconds, data)
        span = reader.metadata
        span_of_file = (file.name, span.start_time, max(0, span.duration - 1), span.message_count)
        topics = [(connection, connection.msgcount) for connection in reader.connections]
        copy.close(VERSION, as_yaml(metadata_of("mcap", [span_of_file], topics)))
    except BaseException:
        with contextlib.suppress(Exception):
            copy.abort()
        raise
