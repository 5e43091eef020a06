"""Detections in a picture, and their overlap with the ground truth.

Boxes are (left, top, right, bottom) of pixel edges [px]: a single pixel at (u, v) has u, v, u + 1,
v + 1.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["Detections", "box_iou", "kept_boxes", "mask_iou"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Detections:
    """Objects that a detector found.

    Attributes
    ----------
    boxes : (N, 4) float64
    scores : (N,) float64
        0 to 1.
    classes : (N,) int64
        Index among COCO's 80 names; -1 for what is none of them.
    masks : tuple of (H, W) bool, or None
        One for each, or None if the detector gives no masks.
    """

    boxes: Array = field(default_factory=lambda: np.zeros((0, 4)))
    scores: Array = field(default_factory=lambda: np.zeros(0))
    classes: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    masks: tuple[NDArray[np.bool_], ...] | None = None

    def __len__(self) -> int:
        return len(self.scores)

    def of_class(self, index: int, least_score: float) -> Detections:
        """Return those of one class with at least a score."""
        chosen = np.flatnonzero((self.classes == index) & (self.scores >= least_score))
        masks = None if self.masks is None else tuple(self.masks[n] for n in chosen)
        return Detections(
            boxes=self.boxes[chosen],
            scores=self.scores[chosen],
            classes=self.classes[chosen],
            masks=masks,
        )


def box_iou(boxes: Array, box: Array) -> Array:
    """Return (N,) area of the intersection over that of the union of boxes (N, 4) with one (4,)."""
    low = np.maximum(boxes[:, :2], box[:2])
    high = np.minimum(boxes[:, 2:], box[2:])
    common = np.prod(np.maximum(0.0, high - low), axis=1)
    areas = np.prod(boxes[:, 2:] - boxes[:, :2], axis=1)
    both = areas + np.prod(box[2:] - box[:2]) - common
    iou: Array = common / np.maximum(both, 1e-12)
    return iou


def mask_iou(first: NDArray[np.bool_], second: NDArray[np.bool_]) -> float:
    """Return pixels in both over pixels in either; 0 if there are none."""
    return float((first & second).sum() / max(1, (first | second).sum()))


def kept_boxes(
    boxes: Array, scores: Array, classes: NDArray[np.int64], *, least_score: float, overlap: float
) -> NDArray[np.int64]:
    """Return the rows that non-maximum suppression keeps, class by class, best first."""
    corners = np.asarray(boxes, np.float32)
    sizes = np.concatenate([corners[:, :2], corners[:, 2:] - corners[:, :2]], axis=1)
    if not len(sizes):
        return np.zeros(0, np.int64)
    kept = cv2.dnn.NMSBoxesBatched(
        sizes.tolist(),
        np.asarray(scores, np.float32).tolist(),
        [int(number) for number in classes],
        least_score,
        overlap,
    )
    rows: NDArray[np.int64] = np.asarray(kept, np.int64).reshape(-1)
    return rows[np.argsort(-scores[rows], kind="stable")]
