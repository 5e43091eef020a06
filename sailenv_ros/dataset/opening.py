"""The doors to a data set: made, its files read, or its frames made without files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

from sailenv_ros.dataset.reader import Dataset
from sailenv_ros.dataset.samples import DatasetSamples, SampleFormat, check_format

if TYPE_CHECKING:
    from sailenv_ros.dataset.job import Job
    from sailenv_ros.dataset.making import MadeDataset, Progress
    from sailenv_ros.dataset.streaming import DatasetStream

__all__ = ["make", "open_dataset", "stream_dataset"]


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
    from sailenv_ros.dataset.job import job_of
    from sailenv_ros.dataset.streaming import DatasetStream

    job = job_of(recipe)
    kind = DatasetStream
    if format == "torch":
        check_format(format)
        # Its base class is PyTorch's, which takes long to import.
        from sailenv_ros.dataset.torch_streams import TorchStream

        kind = TorchStream
    return kind(job, split, format=format, workers=workers, ahead=ahead)


def make(
    recipe: str | Path | Job,
    where: str | Path,
    *,
    workers: int = 1,
    limit: int = 0,
    on_progress: Callable[[Progress], None] | None = None,
) -> MadeDataset:
    """Make the data set of a recipe, or continue one; as ``sailenv dataset make`` does.

    Parameters
    ----------
    recipe : str, Path or Job
        A file.
    where : str or Path
        A folder, or a URL that `fsspec` knows.
    workers : int
        Processes that make it, each with a simulation.
    limit : int
        Frames after which no other shard is begun; 0 makes all.
    on_progress : callable or None
        Called with a `Progress` now and then.

    Returns
    -------
    made : MadeDataset

    Raises
    ------
    RecipeError
        If the recipe's file has errors.
    SailenvError
        As of `make_dataset`.
    """
    from sailenv_ros.dataset.engines import engine_of
    from sailenv_ros.dataset.job import job_of
    from sailenv_ros.dataset.making import make_dataset

    told = {} if on_progress is None else {"on_progress": on_progress}
    return make_dataset(job_of(recipe), where, engine_of(workers, None), limit=limit, **told)
