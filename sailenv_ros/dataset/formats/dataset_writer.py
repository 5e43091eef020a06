"""Frames → data sets in one or several formats: what live programs and `export` write with."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, get_args

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.formats.annotation_rules import ALL_OBJECTS, AnnotationRules
from sailenv_ros.dataset.formats.data_files import write_json
from sailenv_ros.dataset.formats.dataset_format import (
    DatasetFormat,
    FlowDirection,
    Record,
    Sample,
    WriteResult,
)
from sailenv_ros.dataset.formats.formats import check_views, format_class, wanted_formats
from sailenv_ros.dataset.formats.journal import IDENTITY_FILE, FrameJournal
from sailenv_ros.dataset.formats.splits import Splits
from sailenv_ros.dataset.identity import WorkIdentity
from sailenv_ros.dataset.store import ResumableStore
from sailenv_ros.errors import InvalidRequest, InvalidState, PlaceTaken
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.undistorted import undistorted

__all__ = ["SUMMARY_FILE", "DatasetWriter", "FormatSummary", "DatasetSummary"]

OLD_JOURNAL = "unfinished.jsonl"
"""Versions before 0.3 kept what was done in it."""

SUMMARY_FILE = "export.json"
"""Counts of everything written and left out, in the folder of a finished data set."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FormatSummary:
    """Counts of everything that a format wrote, and that it left out, by the reason."""

    written: Mapping[str, int]
    left_out: Mapping[str, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetSummary:
    """Summary of a data set.

    Attributes
    ----------
    frames : int
    splits : mapping of str to int
        Frames of each split; empty if it is not split.
    formats : mapping of str to FormatSummary
    """

    frames: int
    splits: Mapping[str, int]
    formats: Mapping[str, FormatSummary]


class DatasetWriter:
    """Writes frames as data sets; a context manager, which finishes them when it ends well.

    Parameters
    ----------
    folder : str or Path
        Made if it is not there. Several formats get a folder each.
    formats : sequence of str
        Names in `FORMATS`.
    splits : Splits or None
        None does not split.
    flow : {'forward', 'backward', 'both'}
        Which flow those formats write that have the choice: to the next frame, to the one before.
    rules : AnnotationRules
        Which objects are annotated.
    undistort : bool
        True writes what pin-holes would see; see `frame.undistorted`.
    source : str
        What the frames come from, told in the summary.
    resume : bool
        True continues a data set whose writing was interrupted: `done` frames are there, and the
        next one that is added is the next. False needs an empty folder.

    Raises
    ------
    UnknownName, InvalidRequest
        If a format is unknown, or one that is a sequence shall be split.
    PlaceTaken, BegunOtherwise
        If the folder is not empty, or what is in it was begun with other settings.
    WriteFailed
        If the folder cannot be made.
    DeadlineExceeded
        If another process writes this data set.
    """

    def __init__(
        self,
        folder: str | Path,
        formats: Sequence[str],
        *,
        splits: Splits | None = None,
        flow: FlowDirection = "forward",
        rules: AnnotationRules = ALL_OBJECTS,
        undistort: bool = False,
        source: str = "",
        resume: bool = False,
    ) -> None:
        if flow not in get_args(FlowDirection):
            raise InvalidRequest("flow", flow, f"one of: {', '.join(get_args(FlowDirection))}")
        classes = {name: format_class(name) for name in wanted_formats(formats)}
        for name, made in classes.items():
            if splits is not None and made.is_sequence and not made.tells_splits:
                raise InvalidRequest("split", name, "none, as frames of that format are a sequence")
        self.folder = Path(folder)
        self._splits = splits
        self._head = {
            "formats": list(classes),
            "split": None if splits is None else list(splits.shares),
            "seed": 0 if splits is None else splits.seed,
            "flow": flow,
            "source": source,
            **({} if rules == ALL_OBJECTS else {"rules": asdict(rules)}),
            **({"undistort": True} if undistort else {}),
        }
        self._rules, self._undistort = rules, undistort
        if (self.folder / OLD_JOURNAL).is_file():
            raise PlaceTaken(str(self.folder), "holds a data set that an older version began")
        store = ResumableStore(
            FolderStorage(self.folder), WorkIdentity(file=IDENTITY_FILE, settings=self._head)
        )
        with ExitStack() as stack:
            stack.enter_context(store.opened(resume=resume))
            self._journal = FrameJournal(store)
            self._held_place = stack.pop_all()
        self._formats: dict[str, DatasetFormat] = {
            name: made(self.folder / name if len(classes) > 1 else self.folder)
            for name, made in classes.items()
        }
        shared: dict[Any, Any] = {}
        for made_format in self._formats.values():
            made_format.flow, made_format.shared = flow, shared
        self._next = 0
        # Those that cannot go on begin anew, with frames that the others have already.
        if all(made.resumable for made in classes.values()):
            self._next = len(self._journal.entries)
        # Then a frame is written when the one after it is there.
        self._keeps_neighbours = any(made.needs_neighbours for made in classes.values())
        if self._keeps_neighbours:
            self._next = max(0, self._next - 1)
        self._before: Frame | None = None
        self._held: Frame | None = None
        self._summary: DatasetSummary | None = None

    @property
    def done(self) -> int:
        """Number of frames that need not be added again: the next one has this number, from 0."""
        return self._next

    def add(self, frame: Frame) -> None:
        """Write one more frame.

        Raises
        ------
        InvalidRequest
            If it lacks a view that a format needs; nothing was written then.
        RecordingError
            If a file cannot be written.
        """
        if self._summary is not None:
            raise InvalidState("the data set is finished; begin another one")
        if self._undistort:
            frame = undistorted(frame)
        for name in self._formats:
            check_views(name, frame.views)
        if self._keeps_neighbours:
            held, self._held = self._held, frame
            if held is not None:
                self._write(self._next - 1, held, following=frame)
                self._before = held
        else:
            self._write(self._next, frame)
        self._next += 1

    def _write(self, number: int, frame: Frame, following: Frame | None = None) -> None:
        written = len(self._journal.entries)
        split = "" if self._splits is None else self._splits.of_frame(number)
        sample = Sample(
            number=number,
            frame=frame,
            split=split,
            previous=self._before,
            following=following,
            rules=self._rules,
        )
        if number < written:
            for made in self._formats.values():
                if not made.resumable:
                    made.add(sample)
        else:
            entry = {name: made.add(sample) for name, made in self._formats.items()}
            self._journal.add(split, entry)

    def finish(self) -> DatasetSummary:
        """Write what is written at the end; a second call returns the same.

        Raises
        ------
        RecordingError
            If a file cannot be written.
        """
        if self._summary is not None:
            return self._summary
        if self._held is not None:
            self._write(self._next - 1, self._held)
            self._held = None
        self._journal.flush()
        splits, entries = self._journal.splits, self._journal.entries
        for name, made in self._formats.items():
            made.finish(
                [
                    Record(number=number, split=split, value=entry[name].record)
                    for number, (split, entry) in enumerate(zip(splits, entries, strict=True))
                ]
            )
        summary = DatasetSummary(
            frames=len(entries),
            splits=MappingProxyType(dict(Counter(split for split in splits if split))),
            formats=MappingProxyType(
                {name: _totals([entry[name] for entry in entries]) for name in self._formats}
            ),
        )
        write_json(self.folder / SUMMARY_FILE, {**self._head, **_plain(summary)})
        self._journal.finish()
        self._held_place.close()
        self._summary = summary
        return summary

    def close(self) -> None:
        """Leave the data set unfinished, to be continued another time."""
        if self._summary is None:
            with self._held_place:
                self._journal.flush()
                for made in self._formats.values():
                    made.close()

    def __enter__(self) -> DatasetWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, *exc: object) -> None:
        if kind is None:
            self.finish()
        else:
            self.close()


def _totals(made: Sequence[WriteResult]) -> FormatSummary:
    written: Counter[str] = Counter()
    left_out: Counter[str] = Counter()
    for one in made:
        written.update(one.written)
        left_out.update(one.left_out)
    return FormatSummary(written=dict(written), left_out=dict(left_out))


def _plain(summary: DatasetSummary) -> dict[str, Any]:
    return {
        "frames": summary.frames,
        "splits": dict(summary.splits),
        "results": {
            name: {"written": dict(one.written), "left_out": dict(one.left_out)}
            for name, one in summary.formats.items()
        },
    }
