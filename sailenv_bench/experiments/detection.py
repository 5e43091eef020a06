"""Scores of a detector on objects of the rooms: views and detections in, scores by class out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.coco_classes import COCO_NAMES
from sailenv_bench.experiments.detections import Detections, box_iou, mask_iou
from sailenv_bench.experiments.statistics import mean_and_deviation
from sailenv_bench.experiments.viewpoints import Viewpoint

__all__ = ["HIT_IOU", "Scored", "class_scores", "overall_scores", "scored", "with_boxes"]

HIT_IOU = 0.5
"""A box of the right class that overlaps so much with the object's is a hit."""

TRUTH = (80, 220, 120)
FOUND = (255, 90, 80)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scored:
    """Score of a detector at one viewpoint.

    Attributes
    ----------
    best_score : float
        The highest score of the class anywhere in the picture; 0 if it was not named.
    box_iou : float
        Of the class's best box with the object's; 0 if there is none.
    pixel_iou : float or None
        Of all masks of the class with all visible pixels of the category; None without masks.
    box : (4,) tuple of float or None
        That best box [px].
    """

    best_score: float
    box_iou: float
    pixel_iou: float | None
    box: tuple[float, float, float, float] | None

    @property
    def hit(self) -> bool:
        """True if the object was found."""
        return self.box_iou >= HIT_IOU


def scored(viewpoint: Viewpoint, found: Detections, least_score: float) -> Scored:
    """Compare what was found with what is there."""
    index = COCO_NAMES.index(viewpoint.category)
    named = found.of_class(index, least_score)
    pixel_iou = None
    if named.masks is not None:
        seen = np.zeros(viewpoint.target.shape, np.bool_)
        for mask in named.masks:
            seen |= mask
        pixel_iou = mask_iou(seen, viewpoint.of_category)
    if not len(named):
        return Scored(best_score=0.0, box_iou=0.0, pixel_iou=pixel_iou, box=None)
    overlaps = box_iou(named.boxes, viewpoint.box)
    best = int(overlaps.argmax())
    left, top, right, bottom = (float(value) for value in named.boxes[best])
    return Scored(
        best_score=float(named.scores.max()),
        box_iou=float(overlaps[best]),
        pixel_iou=pixel_iou,
        box=(left, top, right, bottom),
    )


def class_scores(name: str, scores: Sequence[Scored], instances: int) -> dict[str, Any]:
    """Sum up a class: hit rate, and mean and deviation of each overlap over its views."""
    pixels = [entry.pixel_iou for entry in scores if entry.pixel_iou is not None]
    return {
        "name": name,
        "views": len(scores),
        "instances": instances,
        "hit_rate": mean_and_deviation(float(entry.hit) for entry in scores)[0],
        "box_iou": mean_and_deviation(entry.box_iou for entry in scores),
        "pixel_iou": mean_and_deviation(pixels),
        "scores": [round(entry.best_score, 3) for entry in scores],
        "box_ious": [round(entry.box_iou, 3) for entry in scores],
    }


def overall_scores(classes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return means over the classes, each class counting once; those without views do not."""
    seen = [entry for entry in classes if entry["views"]]
    return {
        "views": sum(entry["views"] for entry in classes),
        "hit_rate": mean_and_deviation(entry["hit_rate"] for entry in seen)[0],
        "box_iou": mean_and_deviation(entry["box_iou"][0] for entry in seen)[0],
        "pixel_iou": mean_and_deviation(entry["pixel_iou"][0] for entry in seen)[0],
    }


def with_boxes(viewpoint: Viewpoint, score: Scored) -> NDArray[np.uint8]:
    """Return the picture with the object's box (green) and the class's best one (red)."""
    picture = viewpoint.picture.copy()
    for box, colour in ((viewpoint.box, TRUTH), (score.box, FOUND)):
        if box is not None:
            left, top, right, bottom = (round(float(value)) for value in box)
            cv2.rectangle(picture, (left, top), (right - 1, bottom - 1), colour, 2)
    return picture
