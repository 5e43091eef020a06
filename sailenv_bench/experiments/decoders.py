"""Decodes output tensors of detectors: arrays in, `Detections` in the network's input out.

Recognises a network's kind by the shapes of its outputs. Knows no file and no runtime.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.coco_classes import COCO_NAMES, index_of_category_id
from sailenv_bench.experiments.detections import Detections, kept_boxes
from sailenv_ros.errors import InvalidRequest

__all__ = ["DECODERS", "LEAST_SCORE", "Outputs", "class_indices", "recognised"]

Array = NDArray[Any]
Outputs = Mapping[str, Array]
Size = tuple[int, int]

CLASSES = len(COCO_NAMES)
LEAST_SCORE = 0.05
"""Score threshold; detections with a lower score are dropped at once."""

OVERLAP = 0.5
PROTOTYPES = 32
"""Mask coefficients of a YOLO-seg network."""

NANODET_STRIDES = (8, 16, 32, 64)
YOLO_WIDTHS = (4 + CLASSES, 5 + CLASSES, 4 + CLASSES + PROTOTYPES, 5 + CLASSES + PROTOTYPES)
END_TO_END_WIDTHS = (6, 6 + PROTOTYPES)


def recognised(outputs: Outputs) -> str:
    """Return a network's kind by its outputs.

    Returns
    -------
    kind : {'maskrcnn', 'centernet', 'nanodet', 'yolo'}

    Raises
    ------
    InvalidRequest
        If the shapes are those of none of them.
    """
    arrays = list(outputs.values())
    planes = [array.shape[1] for array in arrays if array.ndim == 4]
    if any(a.ndim == 1 and np.issubdtype(a.dtype, np.integer) for a in arrays):
        return "maskrcnn"
    if CLASSES in planes and planes.count(2) >= 1:
        return "centernet"
    rows = [array for array in arrays if array.ndim == 3]
    if sum(array.shape[2] == CLASSES for array in rows) >= 2:
        return "nanodet"
    if len(rows) == 1 and _bins_of(rows[0].shape[2]) >= 8:
        return "nanodet"
    if len(rows) == 1 and {*rows[0].shape[1:]} & {*YOLO_WIDTHS, *END_TO_END_WIDTHS}:
        return "yolo"
    got = ", ".join(f"{name} {array.shape}" for name, array in outputs.items())
    raise InvalidRequest("outputs of the detector", got, f"those of {', '.join(DECODERS)}")


# -- NanoDet -------------------------------------------------------------------------------


def _nanodet(outputs: Outputs, size: Size) -> Detections:
    """Distances from cell centres to the box's sides, each the mean of a distribution.

    X. Li et al., "Generalized Focal Loss", 2020. Older exports have scores and distances of each
    stride apart and cells' centres at half a stride; NanoDet-Plus has all in one, centres at 0.
    """
    rows = [array[0] for array in outputs.values() if array.ndim == 3]
    if len(rows) == 1:
        cells, middle = [(rows[0][:, :CLASSES], rows[0][:, CLASSES:])], 0.0
    else:
        scores = sorted((r for r in rows if r.shape[1] == CLASSES), key=len, reverse=True)
        sides = sorted((r for r in rows if r.shape[1] != CLASSES), key=len, reverse=True)
        cells, middle = list(zip(scores, sides, strict=True)), 0.5
    score = _probabilities(np.concatenate([entry for entry, _ in cells]))
    distance = np.concatenate([entry for _, entry in cells]).astype(np.float64)
    centres, strides = _cells(len(score), size, middle)
    bins = distance.shape[1] // 4
    weights = _softmax(distance.reshape(-1, 4, bins))
    sides_px = weights @ np.arange(bins) * strides[:, None]
    boxes = np.concatenate([centres - sides_px[:, :2], centres + sides_px[:, 2:]], axis=1)
    return _suppressed(boxes, score)


def _bins_of(width: int) -> int:
    """Return the bins of one distance in a row that begins with class scores; 0 if it does not."""
    rest = width - CLASSES
    # A YOLO's row is shorter, or has 32 coefficients of a mask behind its box.
    return rest // 4 if rest >= 32 and rest % 4 == 0 and width not in YOLO_WIDTHS else 0


def _cells(count: int, size: Size, middle: float) -> tuple[Array, Array]:
    """Return centres (N, 2) and strides (N,) of the cells of as many strides as make `count`."""
    centres: list[Array] = []
    strides: list[Array] = []
    for stride in NANODET_STRIDES:
        across, down = (-(-length // stride) for length in size)
        v, u = np.mgrid[0:down, 0:across]
        centres.append((np.stack([u, v], axis=-1).reshape(-1, 2) + middle) * stride)
        strides.append(np.full(across * down, float(stride)))
        if sum(map(len, strides)) == count:
            return np.concatenate(centres), np.concatenate(strides)
    raise InvalidRequest("cells of the detector", count, f"those of strides {NANODET_STRIDES}")


# -- CenterNet -----------------------------------------------------------------------------


def _centernet(outputs: Outputs, size: Size) -> Detections:
    """Peaks of a heat map for each class, with a size and an offset at each place.

    X. Zhou et al., "Objects as Points", 2019. Of two-channel outputs without names that tell, the
    first is the size, as in the authors' own order.
    """
    heat = next(a for a in outputs.values() if a.ndim == 4 and a.shape[1] == CLASSES)[0]
    pairs = {n.lower(): a[0] for n, a in outputs.items() if a.ndim == 4 and a.shape[1] == 2}
    offset_name = next((n for n in pairs if "reg" in n or "off" in n), None)
    sizes = next((a for n, a in pairs.items() if "wh" in n or "size" in n), None)
    if sizes is None:
        sizes = next(a for n, a in pairs.items() if n != offset_name)
    others = [a for a in pairs.values() if a is not sizes]
    offset = others[0] if others else np.zeros_like(sizes)
    heat = _probabilities(heat)
    window = np.ones((3, 3), np.uint8)
    highest = np.stack([cv2.dilate(plane.astype(np.float32), window) for plane in heat])
    classes, v, u = np.nonzero((heat.astype(np.float32) == highest) & (heat >= LEAST_SCORE))
    middle = np.stack([u, v], axis=-1) + offset[:, v, u].T
    half = 0.5 * sizes[:, v, u].T
    factor = np.array([size[0] / heat.shape[2], size[1] / heat.shape[1]])
    boxes = np.concatenate([(middle - half) * factor, (middle + half) * factor], axis=1)
    scores = heat[classes, v, u].astype(np.float64)
    order = np.argsort(-scores, kind="stable")[:100]
    return Detections(
        boxes=boxes[order].astype(np.float64), scores=scores[order], classes=classes[order]
    )


# -- YOLO ----------------------------------------------------------------------------------


def _yolo(outputs: Outputs, size: Size) -> Detections:
    """Rows of a box and class scores: of versions 5 and 7, 8 to 12, and without suppression (10).

    Version 5 has an objectness before the class scores; networks with masks have 32 coefficients
    behind them and their prototypes as a second output.
    """
    rows = next(array[0] for array in outputs.values() if array.ndim == 3)
    if rows.shape[0] in YOLO_WIDTHS and rows.shape[1] not in YOLO_WIDTHS:
        rows = rows.T
    rows = rows.astype(np.float64)
    prototypes = next((a[0] for a in outputs.values() if a.ndim == 4), None)
    if rows.shape[1] in END_TO_END_WIDTHS:
        found = Detections(
            boxes=rows[:, :4], scores=rows[:, 4], classes=rows[:, 5].astype(np.int64)
        )
        kept = np.flatnonzero(found.scores >= LEAST_SCORE)
        rest = rows[:, 6:]
    else:
        objectness = rows.shape[1] in (5 + CLASSES, 5 + CLASSES + PROTOTYPES)
        first = 5 if objectness else 4
        score = rows[:, first : first + CLASSES] * (rows[:, 4:5] if objectness else 1.0)
        middle, half = rows[:, :2], 0.5 * rows[:, 2:4]
        boxes = np.concatenate([middle - half, middle + half], axis=1)
        found = Detections(boxes=boxes, scores=score.max(axis=1), classes=score.argmax(axis=1))
        kept = kept_boxes(
            boxes, found.scores, found.classes, least_score=LEAST_SCORE, overlap=OVERLAP
        )
        rest = rows[:, first + CLASSES :]
    masks = None
    if prototypes is not None and rest.shape[1] == len(prototypes):
        masks = tuple(_prototype_mask(rest[n], prototypes, found.boxes[n], size) for n in kept)
    return Detections(
        boxes=found.boxes[kept],
        scores=found.scores[kept],
        classes=found.classes[kept],
        masks=masks,
    )


def _prototype_mask(
    coefficients: Array, prototypes: Array, box: Array, size: Size
) -> NDArray[np.bool_]:
    """Mix prototypes (C, h, w) to a mask of the input's size, cut off outside the box."""
    mixed = np.tensordot(coefficients, prototypes.astype(np.float64), axes=1)
    grown = cv2.resize(mixed, size, interpolation=cv2.INTER_LINEAR) > 0.0
    u, v = np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5
    inside = ((v >= box[1]) & (v < box[3]))[:, None] & ((u >= box[0]) & (u < box[2]))
    result: NDArray[np.bool_] = grown & inside
    return result


# -- Mask R-CNN ----------------------------------------------------------------------------


def _maskrcnn(outputs: Outputs, size: Size) -> Detections:
    """Boxes, labels, scores and masks as arrays of their own, already suppressed.

    The classes of the result are the network's labels yet: see `class_indices`.
    """
    arrays = list(outputs.values())
    boxes = next(a for a in arrays if a.ndim == 2 and a.shape[1] == 4).astype(np.float64)
    labels = next(a for a in arrays if a.ndim == 1 and np.issubdtype(a.dtype, np.integer))
    scores = next(a for a in arrays if a.ndim == 1 and np.issubdtype(a.dtype, np.floating))
    stack = next((a for a in arrays if a.ndim == 4), None)
    masks = None
    if stack is not None:
        masks = tuple(_pasted(mask[0], box, size) for mask, box in zip(stack, boxes, strict=True))
    return Detections(
        boxes=boxes,
        scores=scores.astype(np.float64),
        classes=labels.astype(np.int64),
        masks=masks,
    )


def _pasted(mask: Array, box: Array, size: Size) -> NDArray[np.bool_]:
    """Return a mask of the input's size, of one that has it or of one of the box alone."""
    if mask.shape == (size[1], size[0]):
        return np.asarray(mask >= 0.5)
    left, top = (int(np.floor(value)) for value in box[:2])
    right, bottom = (int(np.ceil(value)) for value in box[2:])
    result = np.zeros((size[1], size[0]), np.bool_)
    if right <= left or bottom <= top:
        return result
    grown = cv2.resize(mask.astype(np.float32), (right - left, bottom - top)) >= 0.5
    low_u, low_v = max(left, 0), max(top, 0)
    high_u, high_v = min(right, size[0]), min(bottom, size[1])
    if low_u < high_u and low_v < high_v:
        part = grown[low_v - top : high_v - top, low_u - left : high_u - left]
        result[low_v:high_v, low_u:high_u] = part
    return result


def class_indices(labels: NDArray[np.int64], *, of_files: bool) -> NDArray[np.int64]:
    """Turn labels that count from 1 into class indices; -1 for the background.

    Parameters
    ----------
    labels : (N,) int64
    of_files : bool
        True for ids of COCO's files, 1 to 90 with gaps; False for the 80 names from 1 on.
    """
    if of_files:
        return np.array([index_of_category_id(int(label)) for label in labels], np.int64)
    result: NDArray[np.int64] = np.where((labels >= 1) & (labels <= CLASSES), labels - 1, -1)
    return result


# -- inside --------------------------------------------------------------------------------


def _suppressed(boxes: Array, score: Array) -> Detections:
    """Take each row's best class, and of boxes that overlap the best."""
    best, classes = score.max(axis=1), score.argmax(axis=1)
    kept = kept_boxes(boxes, best, classes, least_score=LEAST_SCORE, overlap=OVERLAP)
    return Detections(boxes=boxes[kept], scores=best[kept], classes=classes[kept])


def _probabilities(values: Array) -> Array:
    """Return values from 0 to 1: as they are if they are such, else through the logistic curve."""
    values = values.astype(np.float64)
    if values.size and (values.min() < 0.0 or values.max() > 1.0):
        return np.asarray(1.0 / (1.0 + np.exp(-values)))
    return values


def _softmax(values: Array) -> Array:
    powers = np.exp(values - values.max(axis=-1, keepdims=True))
    return np.asarray(powers / powers.sum(axis=-1, keepdims=True))


DECODERS: Mapping[str, Callable[[Outputs, Size], Detections]] = MappingProxyType(
    {"nanodet": _nanodet, "centernet": _centernet, "yolo": _yolo, "maskrcnn": _maskrcnn}
)
"""Decoders by kind: ``decode(outputs, (width, height) of the input)``; Mask R-CNN's classes are
labels."""
