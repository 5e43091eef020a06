"""Streams of frames as PyTorch's iterable data sets. Imported where PyTorch is wanted alone."""

from __future__ import annotations

from torch.utils.data import IterableDataset

from sailenv_ros.dataset.streaming import DatasetStream

__all__ = ["TorchStream"]


class TorchStream(DatasetStream, IterableDataset):  # type: ignore[misc, unused-ignore]  # Any here
    """A `DatasetStream` that a `DataLoader` iterates over, each of its workers a part."""
