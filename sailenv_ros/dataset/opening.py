"""The doors to a data set: its files read, or its frames made, as such or as samples."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

from sailenv_ros.dataset.reader import Dataset
from sailenv_ros.dataset.samples import DatasetSamples, SampleFormat, check_format

if TYPE_CHECKING:
    from sailenv_ros.dataset.job import Job
    from sailenv_ros.dataset.streaming import DatasetStream

__all__ = ["open_dataset", "stream_dataset"]


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


def stream_dataset(
    recipe: str | Path | Job,
    split: str = "",
    *,
    format: Literal["frame"] | SampleFormat = "frame",
    workers: int = 1,
    ahead: int = 8,
) -> DatasetStream:
    """Return the frames of a recipe, without files; see `DatasetStream`.

    With ``format="torch"`` it is a PyTorch `IterableDataset`, for a `DataLoader`.

    Raises
    ------
    RecipeError
        If the recipe's file has errors.
    """
    # Reading files needs no simulation.
    from sailenv_ros.dataset.job import Job, load_job
    from sailenv_ros.dataset.streaming import DatasetStream

    job = recipe if isinstance(recipe, Job) else load_job(Path(recipe))
    kind = DatasetStream
    if format == "torch":
        check_format(format)
        # Its base class is PyTorch's, which takes long to import.
        from sailenv_ros.dataset.torch_streams import TorchStream

        kind = TorchStream
    return kind(job, split, format=format, workers=workers, ahead=ahead)
