"""Contract of a data-set format: frames go in one by one, files and records come out.

A new format is one module with a subclass of `DatasetFormat`, and a line in `formats.FORMATS`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Literal, TypeAlias

from sailenv_ros.dataset.formats.annotation_rules import ALL_OBJECTS, AnnotationRules
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["DatasetFormat", "FlowDirection", "WriteResult", "Record", "Sample"]

FlowDirection: TypeAlias = Literal["forward", "backward", "both"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Sample:
    """One frame of a data set.

    Attributes
    ----------
    number : int
        Of the frame in the data set, from 0.
    frame : Frame
    split : str
        ``train``, ``val`` or ``test``; empty if the data set is not split.
    previous, following : Frame or None
        The frames before and after it, for formats that need them; None at the ends.
    sequence : str
        Name of what it is a part of, where a data set has several sequences; else empty.
    sequence_number : int or None
        Of that, from 1; None for frames of one recording, whose epochs are counted.
    rules : AnnotationRules
        Which objects are annotated.
    """

    number: int
    frame: Frame
    split: str = ""
    previous: Frame | None = None
    following: Frame | None = None
    sequence: str = ""
    sequence_number: int | None = None
    rules: AnnotationRules = ALL_OBJECTS

    @property
    def stem(self) -> str:
        """Name of the frame's files, without an ending."""
        return f"{self.number:06d}"

    def scene_info(self, format_name: str) -> SceneInfo:
        """Return what was known of the scene.

        Raises
        ------
        RecordingError
            If nothing was: a format of that name cannot do without.
        """
        if self.frame.info is None:
            raise RecordingError(f"{format_name} needs the scene_info, which was not recorded")
        return self.frame.info


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteResult:
    """Result of writing one frame in one format.

    Attributes
    ----------
    record : JSON value
        What `DatasetFormat.finish` needs of the frame; None for nothing. It is kept in a file, so
        that a writer that was killed continues where it was.
    written : mapping of str to int
        How many of what was written: ``{"annotations": 12}``.
    left_out : mapping of str to int
        How many were not, by the reason: ``{"no pixel is visible": 3}``.
    """

    record: Any = None
    written: Mapping[str, int] = field(default_factory=dict)
    left_out: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """The record of a frame, with its number and split."""

    number: int
    split: str
    value: Any


class DatasetFormat(ABC):
    """One format; keeps nothing of the frames that it was given.

    Parameters
    ----------
    folder : Path
        Its own.

    Attributes
    ----------
    views : tuple of str
        Views that a frame must have; none means whatever there is.
    any_of : tuple of str
        Views of which a frame must have at least one; none means no such demand.
    is_sequence : bool
        True if its frames belong together, so that they cannot be split.
    tells_splits : bool
        True if it is a sequence that tells of each frame which split it is of.
    resumable : bool
        False if it must be given all frames again after a break.
    needs_neighbours : bool
        True if its samples shall have the frames before and after theirs.
    needs_facts : bool
        True if its samples' frames shall have `SceneFacts` where a world is there to be asked.
    has_sequences : bool
        True if it is a sequence of which several fit into one folder, by `Sample.sequence`.
    is_shard : bool
        True if its files hold many frames each, of one split: large data sets have several.
    needs_records : bool
        True if a format that `is_shard` has something to write once all shards are known.
    of_one_camera : bool
        True if it cannot hold what several cameras see at once.
    part : int
        Of a format that `is_shard`: number of the part that this writes.
    flow : {'forward', 'backward', 'both'}
        Which flow it writes, if it writes one and there is a choice.
    compression : mapping of str to str
        How views are written that shall not be written plainly, of a format that has the choice;
        see `view_files.COMPRESSIONS`.
    can_compress : bool
        True if it has.
    packages : tuple of str
        Optional packages that it cannot do without.
    shared : dict
        What was found once for all formats that are given the same frames.
    """

    views: ClassVar[tuple[str, ...]] = ()
    any_of: ClassVar[tuple[str, ...]] = ()
    is_sequence: ClassVar[bool] = False
    tells_splits: ClassVar[bool] = False
    resumable: ClassVar[bool] = True
    needs_neighbours: ClassVar[bool] = False
    needs_facts: ClassVar[bool] = False
    has_sequences: ClassVar[bool] = False
    is_shard: ClassVar[bool] = False
    needs_records: ClassVar[bool] = False
    of_one_camera: ClassVar[bool] = False
    can_compress: ClassVar[bool] = False
    packages: ClassVar[tuple[str, ...]] = ()
    flow: FlowDirection = "forward"
    part: int = 0
    compression: Mapping[str, Any] = MappingProxyType({})

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.shared: dict[Any, Any] = {}

    @abstractmethod
    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's files. The same frame may be given again: it writes the same files."""

    def finish(self, records: Sequence[Record]) -> None:  # noqa: B027 - often nothing is left
        """Write what is written once all frames were given.

        Parameters
        ----------
        records : sequence of Record
            One for each frame, in the order of their numbers. They may be read again each time they
            are asked for, so that large data sets need not fit into memory.
        """

    def close(self) -> None:  # noqa: B027 - often nothing is open
        """Free what is open when writing is interrupted; what is not complete goes."""
