"""The door to a data set that is read: as frames, or as samples for trainers."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, overload

from sailenv_ros.dataset.reader import Dataset
from sailenv_ros.dataset.samples import DatasetSamples, SampleFormat

__all__ = ["open_dataset"]


@overload
def open_dataset(
    folder: str | Path, split: str = "", *, format: Literal["frame"] = "frame"
) -> Dataset: ...
@overload
def open_dataset(
    folder: str | Path, split: str = "", *, format: SampleFormat
) -> DatasetSamples: ...
def open_dataset(
    folder: str | Path, split: str = "", *, format: Literal["frame"] | SampleFormat = "frame"
) -> Dataset | DatasetSamples:
    """Open a data set that `sailenv dataset make` has made, or is making.

    Parameters
    ----------
    folder : str or Path
    split : str
        Only that one; empty for all.
    format : {'frame', 'numpy', 'torch'}
        What is read: `DatasetFrame`, or samples that PyTorch's `DataLoader` makes batches of as it
        is, of arrays or of tensors; see `DatasetSamples`.

    Raises
    ------
    RecordingError
        If there is none, or it has neither of the formats that keep frames exactly.
    UnknownName
        If it has no such split, or there is no such format.
    MissingPackage
        If PyTorch is wanted, and not installed.
    """
    dataset = Dataset(Path(folder), split)
    return dataset if format == "frame" else DatasetSamples(dataset, format)
