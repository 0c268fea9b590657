"""metadata.yaml: a bag described as Jazzy's rosbag2 describes it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection, QosTime

from course_kit.base.atomic_files import write_whole
from course_kit.lab.bags.files import METADATA
from course_kit.lab.bags.storage import NO_TIME
from course_kit.ros.private_api.rosbags_parts import DISTRO

VERSION = 9


@dataclass
class Span:
    """One storage file: its name, from when to when its messages are (nanoseconds), and how many."""

    name: str
    start: int = NO_TIME
    end: int = 0
    count: int = 0


def metadata_of(
    storage: str, files: Sequence[Span], topics: Sequence[Connection], custom_data: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """rosbag2's description of a bag, from its files and its topics."""
    filled = [span for span in files if span.count]
    start = min((span.start for span in filled), default=NO_TIME)
    end = max((span.end for span in filled), default=NO_TIME)
    return {
        "version": VERSION,
        "storage_identifier": storage,
        "duration": {"nanoseconds": end - start},
        "starting_time": {"nanoseconds_since_epoch": start},
        "message_count": sum(span.count for span in files),
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": connection.topic,
                    "type": connection.msgtype,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": profiles_of(connection),
                    "type_description_hash": connection.digest,
                },
                "message_count": connection.msgcount,
            }
            for connection in topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [span.name for span in files],
        "files": [
            {
                "path": span.name,
                "starting_time": {"nanoseconds_since_epoch": span.start},
                "duration": {"nanoseconds": span.end - span.start if span.count else 0},
                "message_count": span.count,
            }
            for span in files
        ],
        "custom_data": dict(custom_data) if custom_data else None,
        "ros_distro": DISTRO,
    }


def profiles_of(connection: Connection) -> list[dict[str, Any]]:
    """The QoS profiles of a topic's publishers as rosbag2 writes them: policies by their names, times in parts."""

    def plain(value: Any) -> Any:
        if isinstance(value, Enum):
            return value.name.lower()
        return value._asdict() if isinstance(value, QosTime) else value

    profiles = connection.ext.offered_qos_profiles  # type: ignore[union-attr]
    return [{name: plain(value) for name, value in profile._asdict().items()} for profile in profiles]


def write_metadata(folder: Path, metadata: Mapping[str, Any]) -> None:
    """Write metadata.yaml, all of it or nothing. Raises NotWritten."""
    write_whole(folder / METADATA, as_yaml({"rosbag2_bagfile_information": metadata}).encode())


def as_yaml(data: Any) -> str:
    """YAML as in metadata.yaml, the keys in their order."""
    import yaml

    return str(yaml.safe_dump(data, sort_keys=False, default_flow_style=False))
