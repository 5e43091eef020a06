"""Boxes and outlines drawn over pictures: where they are, and where nothing is drawn."""

from __future__ import annotations

import numpy as np

from sailenv_ros.frame.pictures.object_pictures import (
    draw_amodal_outlines,
    draw_boxes,
    draw_boxes_in_space,
)
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.visible_parts import visible_parts
from tests.unit.frame.truth.test_object_table import LENS, frame_of

BLACK = np.zeros((30, 40, 3), np.uint8)


def drawn_at(picture: np.ndarray) -> np.ndarray:
    return (picture > 0).any(axis=-1)


def test_a_box_lies_upon_the_outermost_pixels() -> None:
    """Its corners are those of the object; what is below stays as it is, and a table has labels."""
    instance = np.zeros((30, 40), np.uint16)
    instance[5:20, 7:31] = 3
    drawn = drawn_at(draw_boxes(BLACK, visible_parts(instance)))
    rows, columns = np.nonzero(drawn)
    assert [columns.min(), rows.min(), columns.max(), rows.max()] == [7, 5, 30, 19]
    assert not drawn[6:19, 8:30].any()
    assert not BLACK.any()
    labelled = drawn_at(draw_boxes(BLACK, frame_of(instance=instance).objects))
    assert labelled[6:19, 8:30].any()
    assert not drawn_at(draw_boxes(BLACK, visible_parts(np.zeros((30, 40), np.uint16)))).any()


def test_a_box_in_space_has_its_corners() -> None:
    """Lines pass through the corners that lie in the picture; what is behind is left out."""
    instance = np.full((30, 40), 3, np.uint16)
    instance[0] = 7
    table = frame_of(instance=instance).objects
    drawn = drawn_at(draw_boxes_in_space(BLACK, table))
    inside = [c for c in table.corner_pixels[0] if (c > 1).all() and (c < (38, 28)).all()]
    assert inside
    for u, v in np.rint(inside).astype(int):
        assert drawn[v - 1 : v + 2, u - 1 : u + 2].any()
    assert not drawn_at(draw_boxes_in_space(BLACK, table.select([1]))).any()
    assert LENS.width == 40


def test_an_outline_is_the_border_of_the_mask() -> None:
    """No pixel inside is touched."""
    masks = AmodalMasks(
        height=30, width=40, ids=np.array([3], np.uint16), pixels=np.array([100]),
        whole_pixels=np.array([100]), boxes=np.array([[5, 6, 14, 15]], np.int32),
        whole_boxes=np.array([[5, 6, 14, 15]], np.int32), crops=(np.ones((10, 10), bool),),
    )  # fmt: skip
    drawn = drawn_at(draw_amodal_outlines(BLACK, masks))
    assert drawn[6, 5:15].all()
    assert drawn[6:16, 5].all()
    assert not drawn[8:14, 7:13].any()
    assert not drawn_at(draw_amodal_outlines(BLACK, masks, [])).any()
