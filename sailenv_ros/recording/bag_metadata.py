"""Writes `metadata.yaml`, by which rosbag2 knows a bag folder; version 9 as in Jazzy.

Counts and times in, a file out. Knows no messages.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.topics import RecordedTopic
from sailenv_ros.system.files import write_file

__all__ = ["METADATA_FILE", "FileSummary", "metadata_text", "write_metadata"]

METADATA_FILE = "metadata.yaml"

_VERSION = 9
_NEVER_NS = 2**63 - 1
"""Start time that rosbag2 gives a bag without messages [ns]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FileSummary:
    """One file of a bag.

    Attributes
    ----------
    name : str
        Relative to the folder.
    start_ns, end_ns : int
        Earliest and latest log time [ns]; zeros if there is no message.
    counts : mapping of str to int
        How many messages each topic has in it.
    """

    name: str
    start_ns: int
    end_ns: int
    counts: Mapping[str, int]

    @property
    def message_count(self) -> int:
        """Messages of all topics."""
        return sum(self.counts.values())


def metadata_text(topics: Sequence[RecordedTopic], files: Sequence[FileSummary]) -> str:
    """Return the text of `metadata.yaml`."""
    filled = [file for file in files if file.message_count]
    start_ns = min((file.start_ns for file in filled), default=_NEVER_NS)
    end_ns = max((file.end_ns for file in filled), default=start_ns)
    information = {
        "version": _VERSION,
        "storage_identifier": "mcap",
        "duration": {"nanoseconds": end_ns - start_ns},
        "starting_time": {"nanoseconds_since_epoch": start_ns},
        "message_count": sum(file.message_count for file in files),
        "topics_with_message_count": [
            _topic(topic, sum(file.counts.get(topic.name, 0) for file in files)) for topic in topics
        ],
        # Chunks are compressed, which is the file's own affair.
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.name for file in files],
        "files": [_file(file) for file in files],
        "custom_data": {},
        "ros_distro": os.environ.get("ROS_DISTRO", "jazzy"),
    }
    return yaml.dump({"rosbag2_bagfile_information": information}, Dumper=_Plain, sort_keys=False)


def write_metadata(
    folder: Path, topics: Sequence[RecordedTopic], files: Sequence[FileSummary]
) -> Path:
    """Write `metadata.yaml` whole or not at all; return its path.

    Raises
    ------
    RecordingError
        If it cannot be written.
    """
    path = folder / METADATA_FILE
    try:
        write_file(path, metadata_text(topics, files).encode())
    except OSError as problem:
        raise RecordingError(
            f"{path} cannot be written: {problem.strerror}; once there is room,"
            f" `sailenv bag recover {folder}` writes it"
        ) from None
    return path


def _topic(topic: RecordedTopic, count: int) -> dict[str, Any]:
    return {
        "topic_metadata": {
            "name": topic.name,
            "type": topic.type,
            "serialization_format": "cdr",
            # Must say the same as the channel's metadata, else some readers pass the topic over.
            "offered_qos_profiles": [topic.qos.profile()],
            "type_description_hash": topic.type_hash,
        },
        "message_count": count,
    }


def _file(file: FileSummary) -> dict[str, Any]:
    start_ns = file.start_ns if file.message_count else _NEVER_NS
    return {
        "path": file.name,
        "starting_time": {"nanoseconds_since_epoch": start_ns},
        "duration": {"nanoseconds": file.end_ns - file.start_ns if file.message_count else 0},
        "message_count": file.message_count,
    }


class _Plain(yaml.SafeDumper):
    """Writes no aliases, which rosbag2 does not read."""

    def ignore_aliases(self, data: Any) -> bool:
        return True
