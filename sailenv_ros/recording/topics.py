"""Data types of recordings: a recorded topic, and the options of writing.

Made by the table of channels or read from a file; goes to the writer and to `metadata.yaml`.
Knows neither ROS nor files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

import yaml

from sailenv_ros.errors import InvalidRequest, RecordingError, UnknownName
from sailenv_ros.recording.mcap import Compression
from sailenv_ros.system.yaml_text import from_yaml
from sailenv_ros.types.validation import is_finite_number

__all__ = ["OfferedQos", "RecordedTopic", "RecordingOptions", "qos_of_yaml"]

_INFINITE = {"sec": 9223372036, "nsec": 854775807}
"""The infinite duration, as rosbag2 writes it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OfferedQos:
    """The quality of service that a topic was offered with; words as in rosbag2.

    Attributes
    ----------
    depth : int
        How many messages are kept.
    reliability : str
        ``"reliable"`` or ``"best_effort"``.
    durability : str
        ``"volatile"`` or ``"transient_local"``.
    """

    depth: int = 3
    reliability: str = "reliable"
    durability: str = "volatile"

    def profile(self) -> dict[str, Any]:
        """Return the profile as rosbag2 lists it."""
        return {
            "history": "keep_last",
            "depth": self.depth,
            "reliability": self.reliability,
            "durability": self.durability,
            "deadline": dict(_INFINITE),
            "lifespan": dict(_INFINITE),
            "liveliness": "automatic",
            "liveliness_lease_duration": dict(_INFINITE),
            "avoid_ros_namespace_conventions": False,
        }

    def yaml(self) -> str:
        """Return the text that a channel of the file carries."""
        return yaml.safe_dump([self.profile()], sort_keys=False)


def qos_of_yaml(text: str) -> OfferedQos:
    """Read the first profile of a channel's text; what it does not say is as by default."""
    try:
        profiles = from_yaml(text) if text else None
    except yaml.YAMLError as problem:
        raise RecordingError(f"offered_qos_profiles of a channel is no YAML: {problem}") from None
    first = profiles[0] if isinstance(profiles, list) and profiles else {}
    if not isinstance(first, dict):
        return OfferedQos()
    # Before version 9 of rosbag2's format the words were the numbers of rmw.
    depth = first.get("depth", 0)
    return OfferedQos(
        depth=depth if isinstance(depth, int) and 0 < depth < 10_000 else 3,
        reliability=_word(first, "reliability", {"reliable": 1, "best_effort": 2}),
        durability=_word(first, "durability", {"volatile": 2, "transient_local": 1}),
    )


def _word(profile: Mapping[str, Any], key: str, numbers: Mapping[str, int]) -> str:
    """Read a word; before version 9 of rosbag2's format it was the number that rmw gives it."""
    value = profile.get(key)
    words = [word for word, number in numbers.items() if value in (word, number)]
    return words[0] if words else next(iter(numbers))


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedTopic:
    """One topic of a recording.

    Attributes
    ----------
    name : str
        Full name, e.g. ``"/sailenv/agent/rgb"``.
    type : str
        Of its messages, e.g. ``"sensor_msgs/msg/Image"``.
    schema : str
        Definition of that type and of all it consists of (``ros2msg``).
    qos : OfferedQos
    type_hash : str
        As ROS computes it (``RIHS01_…``); empty if not known.
    bulky : bool
        True for images: they are kept apart from what is small, so that a reader finds its way
        without unpacking them.
    """

    name: str
    type: str
    schema: str
    qos: OfferedQos = OfferedQos()
    type_hash: str = ""
    bulky: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingOptions:
    """Options for writing a recording.

    Attributes
    ----------
    compression : {'zstd', 'lz4', 'none'}
        Of chunks.
    chunk_bytes : int
        Size at which a chunk is finished [B]; a crash can lose the one that is being filled.
    split_bytes : int
        A new file begins when one has reached this size [B]; 0 = one file.
    split_s : float
        A new file begins when one covers this much recorded time [s]; 0 = one file.

    Raises
    ------
    InvalidRequest
        If one of them is out of its range.
    """

    compression: Compression = "zstd"
    chunk_bytes: int = 2**20
    split_bytes: int = 0
    split_s: float = 0.0

    def __post_init__(self) -> None:
        if self.compression not in get_args(Compression):
            raise UnknownName("compression", self.compression, get_args(Compression))
        if not 1 <= self.chunk_bytes <= 2**30:
            raise InvalidRequest("chunk_bytes", self.chunk_bytes, "from 1 to 2^30 [B]")
        if self.split_bytes < 0:
            raise InvalidRequest("split_bytes", self.split_bytes, "0 (one file) or more [B]")
        if not (is_finite_number(self.split_s) and self.split_s >= 0.0):
            raise InvalidRequest("split_s", self.split_s, "0 (one file) or more [s]")
