"""Frames of a data set → samples as trainers batch them: mappings of arrays, numbers and texts."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import DTypeLike, NDArray

from sailenv_ros.dataset.reader import Dataset, DatasetFrame
from sailenv_ros.errors import RecordingError, UnknownName
from sailenv_ros.extras import need
from sailenv_ros.types.view_spec import ViewSpec
from sailenv_ros.types.views import VIEWS

__all__ = ["DatasetSamples", "SampleFormat", "check_format", "sample_of"]

SampleFormat: TypeAlias = Literal["numpy", "torch"]

Sample: TypeAlias = dict[str, Any]


class DatasetSamples(Sequence[Sample]):
    """The frames of a data set as samples that PyTorch's `default_collate` makes batches of.

    Each sample has the same keys, types and, with cameras of one size, shapes. Can be sent to
    other processes.

    Parameters
    ----------
    dataset : Dataset
    format : {'numpy', 'torch'}
        ``numpy``: views as `VIEWS` says, category ids always as uint16. ``torch``: as tensors with
        the channels first, ids and RAW data as int32 (PyTorch hardly computes with uint16).

    Raises
    ------
    UnknownName
        If there is no such format.
    MissingPackage
        If it is ``torch``, and PyTorch is not installed.

    Notes
    -----
    The keys are the recipe's views; ``number``, ``clip``, ``time``, ``stamp_ns`` and ``dt_ns``;
    ``split``, ``camera`` and ``scene``; ``K`` (3, 3) and ``world_from_camera`` (4, 4), float64.
    Arrays are the caller's own. Values that stand for nothing (inf, nan, 0) are as in frames.
    """

    def __init__(self, dataset: Dataset, format: SampleFormat) -> None:
        check_format(format)
        self.dataset = dataset
        self.format = format

    def __len__(self) -> int:
        return len(self.dataset)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        one = self.dataset.frame_at(index, objects=False)
        views, folder = self.dataset.recipe.views, self.dataset.folder
        return sample_of(one, views, self.format, folder, copy=self.dataset.keeps_arrays)

    def __iter__(self) -> Iterator[Sample]:
        return (self[number] for number in range(len(self)))

    def close(self) -> None:
        """Close the files; another look at a sample opens them again."""
        self.dataset.close()

    def __enter__(self) -> DatasetSamples:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def check_format(format: str) -> None:
    """Refuse a format of samples that is unknown, or whose package is not installed."""
    if format not in get_args(SampleFormat):
        raise UnknownName("format", format, ("frame", *get_args(SampleFormat)))
    if format == "torch":
        need("torch", "the format 'torch'")


def sample_of(
    one: DatasetFrame,
    views: Collection[str],
    format: SampleFormat,
    source: object,
    *,
    copy: bool = True,
) -> Sample:
    """Return a frame as a sample; see `DatasetSamples`.

    Parameters
    ----------
    one : DatasetFrame
    views : collection of str
        Of the recipe.
    format : {'numpy', 'torch'}
    source : object
        Where it is from, for errors.
    copy : bool
        False hands the frame's own arrays over where they may be: nobody else may hold them, and
        the frame must not be used afterwards.
    """
    frame = one.frame
    missing = [view for view in views if view not in frame]
    if missing:
        raise RecordingError(f"{source}: frame {one.number} lacks {', '.join(missing)}")
    made = _MAKERS[format]
    return {
        **{view: made(VIEWS[view], frame[view], copy) for view in VIEWS if view in views},
        "K": made(None, frame.camera.intrinsics.K, True),
        "world_from_camera": made(None, frame.camera.world_from_camera, True),
        "number": one.number,
        "clip": one.clip,
        "time": one.time,
        "stamp_ns": frame.stamp_ns,
        "dt_ns": frame.dt_ns,
        "split": one.split,
        "camera": one.camera,
        "scene": frame.scene,
    }


def _own(values: NDArray[Any], dtype: DTypeLike, copy: bool) -> NDArray[Any]:
    """Return values of a type that may be written to."""
    if copy or values.dtype != dtype:
        return values.astype(dtype)
    try:
        values.flags.writeable = True
    except ValueError:  # They stand in memory that is not an array's.
        return values.copy()
    return values


def _array(spec: ViewSpec | None, values: NDArray[Any], copy: bool) -> NDArray[Any]:
    """Return an array of one type for all frames, whatever categories their scenes have."""
    return _own(values, values.dtype if spec is None else spec.dtypes[-1], copy)


def _tensor(spec: ViewSpec | None, values: NDArray[Any], copy: bool) -> Any:
    """Return a tensor of a type that PyTorch computes with."""
    import torch

    is_wide = spec is not None and np.uint16 in spec.dtypes
    tensor = torch.from_numpy(_own(values, np.int32 if is_wide else values.dtype, copy))
    # Making a batch copies anyway, and brings the values into this order then.
    return tensor.permute(2, 0, 1) if spec is not None and spec.channels > 1 else tensor


_MAKERS: Mapping[str, Callable[[ViewSpec | None, NDArray[Any], bool], Any]] = {
    "numpy": _array,
    "torch": _tensor,
}
