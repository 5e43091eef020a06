"""Detectors' outputs, made by hand: each kind is recognised, its boxes are where they were put."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sailenv_bench.experiments.coco_classes import COCO_NAMES, PAPER_CLASSES, index_of_category_id
from sailenv_bench.experiments.decoders import DECODERS, class_indices, recognised
from sailenv_ros.errors import InvalidRequest

SIZE = (128, 96)
CHAIR = COCO_NAMES.index("chair")
BOX = (24.0, 16.0, 88.0, 80.0)
"""What every output here says: a chair of score 0.9 in this box."""

Outputs = dict[str, np.ndarray[Any, Any]]


def nanodet(*, together: bool = False) -> Outputs:
    """A sharp distribution of each side's distance at one cell, of stride 8 or, all in one, 16."""
    strides = (8, 16, 32, 64) if together else (8, 16, 32)
    bins = 8 if together else 11
    middle = 0.0 if together else 0.5
    scores, sides = [], []
    for stride in strides:
        across, down = -(-SIZE[0] // stride), -(-SIZE[1] // stride)
        score = np.full((down, across, 80), 0.01, np.float32)
        side = np.full((down, across, 4, bins), -20.0, np.float32)
        if stride == 16:
            u, v = 3, 3
            score[v, u, CHAIR] = 0.9
            x, y = ((n + middle) * stride for n in (u, v))
            for n, distance in enumerate((x - BOX[0], y - BOX[1], BOX[2] - x, BOX[3] - y)):
                # The mean of two neighbouring bins lies between them.
                low, part = divmod(distance / stride, 1.0)
                side[v, u, n, int(low)] = np.log(1.0 - part + 1e-9)
                side[v, u, n, int(low) + 1] = np.log(part + 1e-9)
        scores.append(score.reshape(1, -1, 80))
        sides.append(side.reshape(1, -1, 4 * bins))
    if together:
        rows = np.concatenate(
            [np.concatenate(pair, axis=2) for pair in zip(scores, sides, strict=True)], axis=1
        )
        return {"out": rows}
    names = [f"out{n}" for n in range(6)]
    return dict(zip(names, [*scores, *sides], strict=True))


def centernet() -> Outputs:
    """A peak at a quarter of the size, as logits, with a neighbour that is no peak."""
    heat = np.full((1, 80, 24, 32), -9.0, np.float32)
    heat[0, CHAIR, 12, 14], heat[0, CHAIR, 12, 15] = np.log(0.9 / 0.1), 1.0
    sizes, offset = (np.zeros((1, 2, 24, 32), np.float32) for _ in range(2))
    sizes[0, :, 12, 14] = (16.0, 16.0)
    return {"hm": heat, "wh": sizes, "reg": offset}


def yolo(*, rows_last: bool, objectness: bool = False, masks: bool = False) -> Outputs:
    """Two boxes of one chair, of which the worse is dropped, and nothing else."""
    first = 5 if objectness else 4
    rows = np.zeros((40, first + 80 + (32 if masks else 0)), np.float32)
    for row, score, shift in ((7, 0.9, 0.0), (8, 0.7, 3.0)):
        rows[row, :4] = (56.0 + shift, 48.0, 64.0, 64.0)
        rows[row, 4] = 0.9 if objectness else 0.0
        rows[row, first + CHAIR] = score / (0.9 if objectness else 1.0)
    outputs = {"output0": (rows.T if rows_last else rows)[None]}
    if masks:
        rows[7, -32] = 1.0
        prototypes = np.full((1, 32, 24, 32), 1.0, np.float32)
        prototypes[0, 0, :, 16:] = -1.0  # the right half of the picture is not the chair
        outputs = {"output0": (rows.T if rows_last else rows)[None], "output1": prototypes}
    return outputs


def end_to_end() -> Outputs:
    """Rows of box, score and class that need no suppression."""
    rows = np.zeros((1, 300, 6), np.float32)
    rows[0, 0] = (*BOX, 0.9, CHAIR)
    return {"output0": rows}


def maskrcnn(mask_size: tuple[int, int] = (28, 28)) -> Outputs:
    """One box, a label of COCO's files, a mask of the box alone or of the picture."""
    mask = np.zeros((1, 1, *mask_size), np.float32)
    mask[0, 0, :, : mask_size[1] // 2] = 1.0
    return {
        "boxes": np.array([BOX], np.float32),
        "labels": np.array([62], np.int64),
        "scores": np.array([0.9], np.float32),
        "masks": mask,
    }


CASES: dict[str, tuple[str, Callable[[], Outputs]]] = {
    "NanoDet": ("nanodet", nanodet),
    "NanoDet-Plus": ("nanodet", lambda: nanodet(together=True)),
    "CenterNet": ("centernet", centernet),
    "YOLOv8": ("yolo", lambda: yolo(rows_last=True)),
    "YOLOv5": ("yolo", lambda: yolo(rows_last=False, objectness=True)),
    "YOLOv8-seg": ("yolo", lambda: yolo(rows_last=True, masks=True)),
    "YOLOv5-seg": ("yolo", lambda: yolo(rows_last=False, objectness=True, masks=True)),
    "YOLOv10": ("yolo", end_to_end),
    "Mask R-CNN": ("maskrcnn", maskrcnn),
}


@pytest.mark.parametrize("name", CASES)
def test_each_kind_is_recognised_and_decoded(name: str) -> None:
    """The box, the score and the class are those that were put into the tensors."""
    kind, make = CASES[name]
    outputs = make()
    assert recognised(outputs) == kind
    found = DECODERS[kind](outputs, SIZE)
    assert len(found) == 1
    np.testing.assert_allclose(found.boxes[0], BOX, atol=1e-3)
    np.testing.assert_allclose(found.scores[0], 0.9, atol=1e-5)
    classes = class_indices(found.classes, of_files=True) if kind == "maskrcnn" else found.classes
    assert list(classes) == [CHAIR]
    assert (found.masks is not None) == ("seg" in name or "Mask" in name)


@pytest.mark.parametrize("name", ["YOLOv8-seg", "YOLOv5-seg"])
def test_prototypes_make_a_mask_inside_the_box(name: str) -> None:
    """Left of the picture's middle the chair, right of it and outside of the box nothing."""
    kind, make = CASES[name]
    (mask,) = DECODERS[kind](make(), SIZE).masks or ()
    assert mask.shape == (96, 128)
    assert mask[16:80, 24:60].all()
    assert not mask[:, 68:].any()
    assert not mask[:16].any()
    assert not mask[:, :24].any()


@pytest.mark.parametrize("size", [(28, 28), (96, 128)])
def test_a_mask_of_the_box_is_put_into_its_place(size: tuple[int, int]) -> None:
    """A mask of the box is grown into it; one of the picture's size is taken as it is."""
    (mask,) = DECODERS["maskrcnn"](maskrcnn(size), SIZE).masks or ()
    right = 56 if size == (28, 28) else 64
    left, top, bottom = (24, 16, 80) if size == (28, 28) else (0, 0, 96)
    expected = np.zeros((96, 128), bool)
    expected[top:bottom, left:right] = True
    assert np.abs(mask.astype(int) - expected).sum() <= 2 * 64


def test_a_mask_beyond_the_border_is_cut_off() -> None:
    """Boxes may lie partly outside of the picture."""
    outputs = maskrcnn()
    outputs["boxes"] = np.array([(-20.0, -20.0, 20.0, 20.0)], np.float32)
    outputs["masks"][:] = 1.0
    (mask,) = DECODERS["maskrcnn"](outputs, SIZE).masks or ()
    assert mask[:20, :20].all()
    assert mask.sum() == 400


def test_labels_count_by_names_or_by_files() -> None:
    """The chair is number 57 of 80, and 62 in COCO's files; 0 is the background in both."""
    labels = np.array([57, 62, 0, 90])
    assert list(class_indices(labels, of_files=False)) == [CHAIR, 61, -1, -1]
    assert list(class_indices(labels, of_files=True)) == [51, CHAIR, -1, 79]
    assert index_of_category_id(90) == 79
    assert index_of_category_id(12) == -1
    assert len(COCO_NAMES) == 80
    assert set(PAPER_CLASSES) <= set(COCO_NAMES)


def test_what_is_no_detector_is_refused() -> None:
    """The sentence shows the shapes."""
    with pytest.raises(InvalidRequest, match=r"logits \(1, 1000\)"):
        recognised({"logits": np.zeros((1, 1000))})
