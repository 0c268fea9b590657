"""metadata.yaml: a bag described as Jazzy's rosbag2 describes it."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag2.metadata import dump_qos_v9

from course_kit.bags.files import METADATA
from course_kit.bags.storage import NO_TIME

VERSION = 9
DISTRO = os.environ.get("ROS_DISTRO") or "jazzy"


def metadata_of(
    storage: str,
    files: Sequence[tuple[str, int, int, int]],
    topics: Sequence[tuple[Connection, int]],
    custom_data: Mapping[str, str] | None = None,
) -> dict[str, Any]:
    """rosbag2's description of a bag, from its files (name, start and duration in ns, messages) and its topics."""
    start = min((begin for _, begin, _, count in files if count), default=NO_TIME)
    end = max((begin + duration for _, begin, duration, count in files if count), default=NO_TIME)
    return {
        "version": VERSION,
        "storage_identifier": storage,
        "duration": {"nanoseconds": end - start},
        "starting_time": {"nanoseconds_since_epoch": start},
        "message_count": sum(count for *_, count in files),
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": connection.topic,
                    "type": connection.msgtype,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": dump_qos_v9(connection.ext.offered_qos_profiles),  # type: ignore[union-attr]
                    "type_description_hash": connection.digest,
                },
                "message_count": count,
            }
            for connection, count in topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [name for name, *_ in files],
        "files": [
            {
                "path": name,
                "starting_time": {"nanoseconds_since_epoch": begin},
                "duration": {"nanoseconds": duration},
                "message_count": count,
            }
            for name, begin, duration, count in files
        ],
        "custom_data": dict(custom_data) if custom_data else None,
        "ros_distro": DISTRO,
    }


def write_metadata(folder: Path, metadata: Mapping[str, Any]) -> None:
    """Write metadata.yaml, all of it or nothing."""
    draft = folder / f"{METADATA}.tmp"
    draft.write_text(as_yaml({"rosbag2_bagfile_information": metadata}), encoding="utf-8")
    draft.replace(folder / METADATA)


def as_yaml(data: Any) -> str:
    """YAML as in metadata.yaml, the keys in their order."""
    import yaml

    return str(yaml.safe_dump(data, sort_keys=False, default_flow_style=False))
