"""The raw-image row of arXiv:2204.12193: pixels classified by their colour and a few templates.

Each object gets at most three labels of one pixel, at least 100 frames apart, on what moves. A
pixel is of the class of the nearest template, or background if none is near enough; the threshold
is the best one of a list, as in the published program.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["LabelledFrame", "best_f1", "draw_templates"]

LABELS = 3
APART_FRAMES = 100

THRESHOLDS = np.array([2.0, 5, 10, 18, 25, 35, 50, 75, 100, 125, 150, 200, 300])
"""Distances of colours [of 255] beyond which a pixel is background."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelledFrame:
    """One picture with the class of each pixel.

    Attributes
    ----------
    number : int
        In its stream.
    colours : (H, W, 3) uint8
    classes : (H, W) int32
        From 0; the highest is the background.
    moves : (H, W) bool
    focus : tuple of int
        Row and column of the focus of attention.
    """

    number: int
    colours: NDArray[np.uint8]
    classes: NDArray[np.int32]
    moves: NDArray[np.bool_]
    focus: tuple[int, int]


def draw_templates(
    frames: Sequence[LabelledFrame], classes: int, rng: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Draw labelled pixels.

    Returns
    -------
    colours : (N, 3) float32
    classes : (N,) int32
    """
    colours: list[Any] = []
    owners: list[int] = []
    for class_ in range(classes):
        given: list[int] = []
        for place in rng.permutation(len(frames)):
            frame = frames[place]
            if any(abs(frame.number - other) < APART_FRAMES for other in given):
                continue
            rows, columns = np.nonzero(frame.moves & (frame.classes == class_))
            if not len(rows):
                continue
            pixel = int(rng.integers(len(rows)))
            colours.append(frame.colours[rows[pixel], columns[pixel]])
            owners.append(class_)
            given.append(frame.number)
            if len(given) == LABELS:
                break
    return np.asarray(colours, np.float32).reshape(-1, 3), np.asarray(owners, np.int32)


def best_f1(
    frames: Sequence[LabelledFrame],
    templates: tuple[NDArray[np.float32], NDArray[np.int32]],
    classes: int,
) -> tuple[float, float]:
    """Return the mean F1 of all classes and the background: whole frames, and at the focus.

    The threshold of both is the one that is best for whole frames.
    """
    count = classes + 1
    whole = np.zeros((len(THRESHOLDS), count, count))
    focus = np.zeros_like(whole)
    for frame in frames:
        true = frame.classes
        distance, nearest = _nearest(frame.colours, *templates)
        for place, threshold in enumerate(THRESHOLDS):
            found = np.where(distance <= threshold, nearest, classes)
            pairs = np.bincount((true * count + found).ravel(), minlength=count * count)
            whole[place] += pairs.reshape(count, count)
            focus[place, true[frame.focus], found[frame.focus]] += 1
    scores = [_mean_f1(matrix) for matrix in whole]
    best = int(np.argmax(scores))
    return scores[best], _mean_f1(focus[best])


def _nearest(
    colours: NDArray[np.uint8], templates: NDArray[np.float32], owners: NDArray[np.int32]
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Return the distance to the nearest template and its class, for each pixel."""
    pixels = colours.astype(np.float32)
    distances = np.stack([np.linalg.norm(pixels - one, axis=-1) for one in templates])
    place = distances.argmin(axis=0)
    return distances.min(axis=0), owners[place]


def _mean_f1(matrix: NDArray[np.float64]) -> float:
    """Return the mean over the classes of a confusion matrix; 0 for one that never occurs."""
    right = matrix.diagonal()
    both = matrix.sum(axis=0) + matrix.sum(axis=1)
    return float(np.divide(2.0 * right, both, out=np.zeros_like(right), where=both > 0).mean())
