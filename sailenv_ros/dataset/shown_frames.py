"""Selection of the frames and views of a data set that a sheet and the page show."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sailenv_ros.dataset.reader import Dataset
from sailenv_ros.errors import RecordingError
from sailenv_ros.types.views import VIEWS

__all__ = ["shown_frames", "shown_views"]


def shown_frames(dataset: Dataset, most: int) -> list[int]:
    """Return numbers of at most so many frames, from all over the data set.

    Raises
    ------
    RecordingError
        If it has no frames.
    """
    if not len(dataset):
        raise RecordingError(f"{dataset.folder} has no frames")
    return [int(n) for n in np.unique(np.linspace(0, len(dataset) - 1, most).astype(int))]


def shown_views(dataset: Dataset, views: Iterable[str]) -> list[str]:
    """Return those of the views that the first frame has; of single pictures none of motion."""
    first = dataset[0].frame
    still = dataset.recipe.clip.frames == 1
    return [
        view
        for view in views
        if view in first.views and not (still and (view == "flow" or VIEWS[view].needs_past_depth))
    ]
