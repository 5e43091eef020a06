"""Scores of detections: overlaps by counting, means by hand, pictures fitted and brought back."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_bench.experiments.coco_classes import COCO_NAMES
from sailenv_bench.experiments.detection import class_scores, overall_scores, scored, with_boxes
from sailenv_bench.experiments.detections import Detections, box_iou, kept_boxes, mask_iou
from sailenv_bench.experiments.detector import fitted
from sailenv_bench.experiments.viewpoints import Viewpoint

CHAIR, COUCH = COCO_NAMES.index("chair"), COCO_NAMES.index("couch")


def viewpoint() -> Viewpoint:
    """A chair of 20 × 10 px in a picture of 40 × 30."""
    target = np.zeros((30, 40), bool)
    target[5:15, 10:30] = True
    return Viewpoint(
        category="chair",
        room="room",
        name="a chair",
        picture=np.zeros((30, 40, 3), np.uint8),
        target=target,
        of_category=target,
        eye_m=(0.0, 0.0, 0.0),
        azimuth_deg=0.0,
        distance_m=1.0,
        cover=target.mean(),
        visible=1.0,
    )


def found(*entries: tuple[tuple[float, ...], float, int], masks: bool = False) -> Detections:
    shown = []
    for box, _, _ in entries:
        mask = np.zeros((30, 40), bool)
        left, top, right, bottom = map(int, box)
        mask[top:bottom, left:right] = True
        shown.append(mask)
    return Detections(
        boxes=np.array([box for box, _, _ in entries], float).reshape(-1, 4),
        scores=np.array([score for _, score, _ in entries]),
        classes=np.array([index for _, _, index in entries], np.int64),
        masks=tuple(shown) if masks else None,
    )


def test_a_box_holds_every_pixel() -> None:
    """Its sides are edges of pixels."""
    np.testing.assert_array_equal(viewpoint().box, (10, 5, 30, 15))


def test_the_right_box_of_the_right_class_counts() -> None:
    """Not the surest one, nor one of another class, nor one below the threshold."""
    result = scored(
        viewpoint(),
        found(
            ((10, 5, 30, 15), 0.2, CHAIR),
            ((10, 5, 30, 15), 0.9, COUCH),
            ((10, 5, 20, 15), 0.5, CHAIR),
            ((30, 20, 40, 30), 0.8, CHAIR),
        ),
        0.3,
    )
    assert result.box_iou == pytest.approx(0.5)
    assert result.hit
    assert result.best_score == 0.8
    assert result.box == (10, 5, 20, 15)
    assert result.pixel_iou is None


def test_what_was_not_named_scores_nothing() -> None:
    """Zero, not left out; without masks there is no pixel IoU, with none found it is 0."""
    assert scored(viewpoint(), found(), 0.3).box_iou == 0.0
    assert (
        scored(viewpoint(), found(((10, 5, 30, 15), 0.9, COUCH), masks=True), 0.3).pixel_iou == 0.0
    )


def test_masks_of_the_class_are_joined() -> None:
    """Two halves of the chair make the whole."""
    halves = found(((10, 5, 20, 15), 0.9, CHAIR), ((20, 5, 30, 15), 0.8, CHAIR), masks=True)
    assert scored(viewpoint(), halves, 0.3).pixel_iou == 1.0


def test_a_class_is_summed_up_over_its_views() -> None:
    """Mean and deviation of 1 and 0, a hit rate of one half."""
    results = [
        scored(viewpoint(), found(((10, 5, 30, 15), 0.9, CHAIR)), 0.3),
        scored(viewpoint(), found(), 0.3),
    ]
    entry = class_scores("chair", results, 2)
    assert entry["hit_rate"] == 0.5
    assert entry["box_iou"] == (0.5, 0.5)
    empty = class_scores("bed", [], 0)
    assert np.isnan(empty["box_iou"][0])
    assert overall_scores([entry, empty])["box_iou"] == 0.5


def test_overlaps_are_areas_in_common() -> None:
    """Of boxes and of masks, empty ones included."""
    boxes = np.array([(0, 0, 2, 2), (1, 0, 3, 2), (5, 5, 6, 6)], float)
    np.testing.assert_allclose(box_iou(boxes, boxes[0]), (1.0, 1 / 3, 0.0))
    nothing = np.zeros((3, 3), bool)
    assert mask_iou(nothing, nothing) == 0.0
    assert mask_iou(~nothing, ~nothing) == 1.0


def test_suppression_is_by_class() -> None:
    """Of boxes that overlap the best of its class stays; another class does not compete."""
    boxes = np.array([(0, 0, 10, 10), (1, 0, 11, 10), (0, 0, 10, 10)], float)
    kept = kept_boxes(
        boxes, np.array([0.6, 0.9, 0.5]), np.array([1, 1, 2]), least_score=0.05, overlap=0.5
    )
    assert list(kept) == [1, 2]
    assert not len(
        kept_boxes(boxes[:0], np.zeros(0), np.zeros(0, int), least_score=0.05, overlap=0.5)
    )


@pytest.mark.parametrize("size", [(64, 64), (40, 30), (20, 90)])
def test_a_picture_that_was_fitted_is_brought_back(size: tuple[int, int]) -> None:
    """Boxes and masks of the network's input are those of the picture again."""
    picture = np.zeros((30, 40, 3), np.uint8)
    picture[5:15, 10:30] = 255
    fit = fitted(picture, size, 114)
    assert fit.picture.shape == (size[1], size[0], 3)
    mask = fit.picture[..., 0] > 190
    v, u = np.nonzero(mask)
    box = np.array([[u.min(), v.min(), u.max() + 1, v.max() + 1]], float)
    back = fit.back(
        Detections(boxes=box, scores=np.ones(1), classes=np.zeros(1, np.int64), masks=(mask,))
    )
    np.testing.assert_allclose(back.boxes[0], (10, 5, 30, 15), atol=1.2 / fit.scale)
    assert mask_iou((back.masks or ())[0], viewpoint().target) > 0.75


def test_boxes_are_drawn_on_a_copy() -> None:
    """The viewpoint keeps its picture."""
    shown = viewpoint()
    drawn = with_boxes(shown, scored(shown, found(((8, 4, 33, 18), 0.9, CHAIR)), 0.3))
    assert drawn.any()
    assert not shown.picture.any()
