"""Labels of single pixels, asked for on demand, as in the experiments of SAILab's papers."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.validation import checked_integer

__all__ = ["MOST_LABELS", "PixelLabel", "pixel_labels"]

MOST_LABELS = 10_000


class PixelLabel(NamedTuple):
    """A pixel and the category and instance that it shows."""

    row: int
    column: int
    category: int
    instance: int


def pixel_labels(
    views: Mapping[str, NDArray[np.generic]],
    frame: int,
    *,
    seed: int = 0,
    count: int = 1,
    of: Collection[int] | None = None,
) -> tuple[PixelLabel, ...]:
    """Return the labels of pixels of a frame, chosen at random.

    Parameters
    ----------
    views : mapping of str to (H, W) array
        With ``category`` and ``instance``.
    frame : int
        Its number: the same seed and number choose the same pixels.
    seed : int
    count : int
        How many, 1 to 10,000; fewer where the frame has fewer such pixels.
    of : collection of int or None
        Ids of categories from which they are chosen; None takes all pixels.

    Returns
    -------
    labels : tuple of PixelLabel
        No pixel twice.

    Raises
    ------
    InvalidRequest
        If a view is missing, or the count not accepted.
    """
    for name in ("category", "instance"):
        if name not in views:
            raise InvalidRequest("views", tuple(views), f"views with {name!r}")
    count = checked_integer("count", count, 1, MOST_LABELS)
    category, instance = views["category"], views["instance"]
    wanted = np.ones(category.shape, bool) if of is None else np.isin(category, list(of))
    places = np.flatnonzero(wanted)
    dice = RandomStream("labels", seed, frame)
    chosen = places[dice.places(len(places), min(count, len(places)))]
    rows, columns = np.divmod(chosen, category.shape[1])
    return tuple(
        PixelLabel(row, column, int(category[row, column]), int(instance[row, column]))
        for row, column in zip(rows.tolist(), columns.tolist(), strict=True)
    )
