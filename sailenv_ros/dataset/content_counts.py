"""Records of frames → what is in a data set: counts by split, scene and category, histograms."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sailenv_ros.dataset.histograms import histogram_svg

__all__ = ["ContentCounts", "content_counts"]

SIZE_EDGES = (1, 16, 64, 256, 1024, 4096, 16384, 65536, 262144)
"""Bin edges of the histogram of visible pixels."""

SHARE_EDGES = tuple(0.1 * step for step in range(11))
DISTANCE_EDGES = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 20.0)


@dataclass(eq=False, slots=True)
class ContentCounts:
    """Counts of the contents of a data set.

    Attributes
    ----------
    frames, scenes : Counter of str
        Frames of each split, and of each scene.
    objects, frames_with : Counter of str
        Visible objects of each category, and frames with at least one.
    sizes, shares, distances : Counter of int
        Objects by visible pixels, visible share, distance [m]: of each bin of the histogram.
    """

    frames: Counter[str] = field(default_factory=Counter)
    scenes: Counter[str] = field(default_factory=Counter)
    objects: Counter[str] = field(default_factory=Counter)
    frames_with: Counter[str] = field(default_factory=Counter)
    sizes: Counter[int] = field(default_factory=Counter)
    shares: Counter[int] = field(default_factory=Counter)
    distances: Counter[int] = field(default_factory=Counter)

    def histograms(self) -> dict[str, str]:
        """Return drawings (SVG) of what was counted, by the names of their files."""
        return {
            name: histogram_svg([counts[bin_] for bin_ in range(len(edges) - 1)], edges, title)
            for name, edges, counts, title in (
                ("sizes", SIZE_EDGES, self.sizes, "visible pixels of an object"),
                ("visible_shares", SHARE_EDGES, self.shares, "visible share of an object"),
                ("distances", DISTANCE_EDGES, self.distances, "distance of an object [m]"),
            )
            if counts
        }


def content_counts(records: Iterable[Mapping[str, Any]]) -> ContentCounts:
    """Return the counts of the frames whose records these are; see `merging.frame_records`."""
    found = ContentCounts()
    for record in records:
        found.frames[record["split"]] += 1
        found.scenes[record["scene"]] += 1
        names = [entry[0] for entry in record["objects"]]
        found.objects.update(names)
        found.frames_with.update(set(names))
        for _, pixels, share, distance in record["objects"]:
            found.sizes[_bin(SIZE_EDGES, pixels)] += 1
            if share is not None:
                found.shares[_bin(SHARE_EDGES, share)] += 1
            if distance is not None:
                found.distances[_bin(DISTANCE_EDGES, distance)] += 1
    return found


def _bin(edges: Sequence[float], value: float) -> int:
    last = len(edges) - 2
    return int(np.clip(np.searchsorted(edges, value, side="right") - 1, 0, last))
