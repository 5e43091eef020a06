"""A bag folder or a single MCAP file → its topics, and its messages in order or at random.

Files of one bag are read as one. Of other programs' recordings everything is read that is CDR.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from sailenv_ros.errors import RecordingError, UnknownName
from sailenv_ros.recording.bag_metadata import METADATA_FILE
from sailenv_ros.recording.mcap.file_index import ENTRY, FileIndex, RawMessage
from sailenv_ros.recording.topics import RecordedTopic, qos_of_yaml
from sailenv_ros.system.yaml_text import from_yaml

__all__ = ["RecordingReader", "files_of"]

_ENTRY = np.dtype([*ENTRY.descr, ("file", "<u2"), ("topic", "<u2"), ("rank", "u1")])

_RANKS = (("SceneInfo", 0), ("Clock", 0), ("Image", 1), ("FrameInfo", 3))
"""Order of messages recorded at one instant, by type: lower ranks first, a frame's info last."""


class RecordingReader:
    """A recording that is read; a context manager. Used by one thread at a time.

    Parameters
    ----------
    path : str or Path
        A bag folder, or one MCAP file.

    Raises
    ------
    RecordingError
        If it is not there, is no recording, or is damaged.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._files: list[FileIndex] = []
        self._topics: dict[str, RecordedTopic] = {}
        self._places: dict[str, int] = {}
        try:
            for file in files_of(self.path):
                self._files.append(FileIndex(file))
            parts = [self._take(number, file) for number, file in enumerate(self._files)]
        except BaseException:
            self.close()
            raise
        self._names = list(self._places)
        joined = np.concatenate(parts)
        order = np.lexsort([joined[key] for key in _ORDER])
        self._entries: NDArray[np.void] = joined[order]

    @property
    def topics(self) -> tuple[RecordedTopic, ...]:
        """Every topic that there is, also those without a message."""
        return tuple(self._topics.values())

    @property
    def start_ns(self) -> int:
        """Log time of the first message [ns]; 0 if there is none."""
        return int(self._entries["log_ns"][0]) if len(self._entries) else 0

    @property
    def end_ns(self) -> int:
        """Log time of the last message [ns]; 0 if there is none."""
        return int(self._entries["log_ns"][-1]) if len(self._entries) else 0

    def __len__(self) -> int:
        return len(self._entries)

    def topic(self, name: str) -> RecordedTopic:
        """Return the topic of that name.

        Raises
        ------
        UnknownName
            If there is none.
        """
        if name not in self._topics:
            raise UnknownName("topic", name, self._topics)
        return self._topics[name]

    def rows(self, topic: str) -> NDArray[np.int64]:
        """Return the numbers of a topic's messages, in order of time."""
        place = self._places[self.topic(topic).name]
        return np.flatnonzero(self._entries["topic"] == place)

    def log_ns(self, rows: NDArray[np.int64] | int) -> NDArray[np.uint64]:
        """Return the log times of messages by their numbers [ns]."""
        times: NDArray[np.uint64] = self._entries["log_ns"][rows]
        return times

    def message(self, row: int) -> tuple[RecordedTopic, RawMessage]:
        """Read the message of that number, and say what topic it is of."""
        entry = self._entries[row]
        name = self._names[int(entry["topic"])]
        file = self._files[int(entry["file"])]
        return self._topics[name], file.message(entry)

    def messages(
        self, topics: Iterable[str] | None = None, *, start_ns: int = 0, end_ns: int | None = None
    ) -> Iterator[tuple[RecordedTopic, RawMessage]]:
        """Read messages in order of time.

        Parameters
        ----------
        topics : iterable of str or None
            Names; None means all.
        start_ns, end_ns : int
            Log times of the first and the last that are given [ns].
        """
        times = self._entries["log_ns"]
        wanted = times >= start_ns
        if end_ns is not None:
            wanted &= times <= end_ns
        if topics is not None:
            places = [self._places[self.topic(name).name] for name in topics]
            wanted &= np.isin(self._entries["topic"], places)
        for row in np.flatnonzero(wanted):
            yield self.message(int(row))

    def close(self) -> None:
        """Close the files; a second call does nothing."""
        for file in self._files:
            file.close()

    def __enter__(self) -> RecordingReader:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _take(self, number: int, file: FileIndex) -> NDArray[np.void]:
        """Return a file's entries with the bag's own numbers of topics."""
        entries = np.empty(len(file.entries), _ENTRY)
        for key in ENTRY.names or ():
            entries[key] = file.entries[key]
        entries["file"] = number
        known = np.zeros(len(entries), np.bool_)
        for channel in file.channels.values():
            if channel.message_encoding != "cdr":
                continue  # other programs' records, which have no place on a ROS topic
            schema = file.schemas.get(channel.schema_id)
            name, type_name = channel.topic, schema.name if schema else ""
            if name not in self._topics:
                self._places[name] = len(self._places)
                self._topics[name] = RecordedTopic(
                    name=name,
                    type=type_name,
                    schema=schema.data.decode(errors="replace") if schema else "",
                    qos=qos_of_yaml(channel.metadata.get("offered_qos_profiles", "")),
                    type_hash=channel.metadata.get("topic_type_hash", ""),
                )
            of_channel = entries["channel"] == channel.id
            known |= of_channel
            entries["topic"][of_channel] = self._places[name]
            entries["rank"][of_channel] = _rank(type_name)
        return entries[known]


_ORDER = ("offset", "chunk", "file", "rank", "log_ns")
"""Keys of the order of messages, the first one last."""


def files_of(path: Path) -> list[Path]:
    """Return the MCAP files of a bag folder in their order, or the file itself.

    Raises
    ------
    RecordingError
        If there is none.
    """
    if not path.is_dir():
        if not path.exists():
            raise RecordingError(f"{path} is not there; give a bag's folder or an MCAP file")
        return [path]
    named = _named_files(path / METADATA_FILE)
    files = [path / name for name in named] if named else _numbered_files(path)
    if not files:
        raise RecordingError(f"{path} has no MCAP file in it; give a bag's folder or such a file")
    return files


def _named_files(metadata: Path) -> list[str]:
    try:
        text = metadata.read_text(encoding="utf-8")
        names = from_yaml(text)["rosbag2_bagfile_information"]["relative_file_paths"]
    except (OSError, yaml.YAMLError, KeyError, TypeError):
        return []  # as after a crash: the files alone tell
    return [name for name in names if isinstance(name, str)] if isinstance(names, list) else []


def _numbered_files(folder: Path) -> list[Path]:
    def key(path: Path) -> tuple[int, str]:
        number = re.search(r"_(\d+)\.mcap$", path.name)
        return (int(number[1]) if number else 0, path.name)

    return sorted(folder.glob("*.mcap"), key=key)


def _rank(type_name: str) -> int:
    return next((rank for end, rank in _RANKS if type_name.endswith(f"/{end}")), 2)
