"""Ids of a clip's pixels → each object's mask over all its frames, as one sequence of runs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.coco_rle import run_lengths_text

__all__ = ["VideoMasks"]


class VideoMasks:
    """Masks of the objects of a clip; keeps runs, not pictures."""

    def __init__(self) -> None:
        self._runs: dict[int, list[NDArray[np.int64]]] = defaultdict(list)
        self._shape: tuple[int, int] = (0, 0)
        self._frames = 0

    def add(self, instance: NDArray[np.integer[Any]]) -> None:
        """Add the next frame's (H, W) ids; 0 is nobody's."""
        height, width = self._shape = instance.shape
        pixels = instance.ravel()
        begins = np.flatnonzero(np.diff(pixels, prepend=-1))
        owners = pixels[begins]
        runs = np.stack([begins, np.append(begins[1:], len(pixels))], axis=1)
        runs += self._frames * height * width
        for owner in np.unique(owners[owners > 0]).tolist():
            self._runs[owner].append(runs[owners == owner])
        self._frames += 1

    def entries(self, phrases: Mapping[int, str]) -> list[dict[str, Any]]:
        """Return what Cosmos Transfer's data sets hold of each object.

        Its mask is one column of all pixels, frame by frame and row by row, as ``pycocotools``
        decodes it.

        Parameters
        ----------
        phrases : mapping of int to str
            What each object is called.
        """
        shape = [self._frames, *self._shape]
        total = int(np.prod(shape))
        found = []
        for owner, parts in sorted(self._runs.items()):
            runs = np.concatenate(parts)
            # A run that ends with a picture goes on in the next one.
            joined = np.append(True, runs[1:, 0] > runs[:-1, 1])
            begins, ends = runs[joined, 0], runs[np.append(joined[1:], True), 1]
            borders = np.concatenate([[0], np.stack([begins, ends], axis=1).ravel(), [total]])
            text = run_lengths_text(np.diff(borders).tolist())
            mask = {"data": {"size": [total, 1], "counts": text.encode()}, "mask_shape": shape}
            phrase = phrases.get(owner, "object")
            found.append({"phrase": phrase, "segmentation_mask_rle": mask})
        return found
