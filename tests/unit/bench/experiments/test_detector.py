"""Detectors from files: networks that always answer the same, read, recognised and run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sailenv_bench.experiments.coco_classes import COCO_NAMES
from sailenv_bench.experiments.detector import INPUTS, Detector
from sailenv_ros.errors import InvalidRequest, UnknownName
from tests.support.tiny_onnx import constant_network
from tests.unit.bench.experiments.test_decoders import BOX, CASES, SIZE

PICTURE = np.zeros((SIZE[1] * 2, SIZE[0] * 2, 3), np.uint8)
"""Twice as large as the networks' input, so boxes are twice as large in it."""


@pytest.mark.parametrize("name", CASES)
def test_a_file_is_recognised_and_answers_in_the_pictures_pixels(name: str, tmp_path: Path) -> None:
    """A chair in twice the box, with a mask of the picture's size where there are masks."""
    kind, make = CASES[name]
    path = tmp_path / "net.onnx"
    path.write_bytes(constant_network(make(), size=SIZE))
    detector = Detector(path)
    found = detector.detect(PICTURE)
    assert (detector.format, detector.size) == (kind, SIZE)
    assert [COCO_NAMES[index] for index in found.classes] == ["chair"]
    np.testing.assert_allclose(found.boxes[0], 2 * np.asarray(BOX), atol=1e-2)
    for mask in found.masks or ():
        assert mask.shape == PICTURE.shape[:2]


def test_labels_of_mask_rcnn_may_count_names(tmp_path: Path) -> None:
    """Label 62 is then the 62nd name."""
    path = tmp_path / "net.onnx"
    path.write_bytes(constant_network(CASES["Mask R-CNN"][1](), size=SIZE))
    for detector in (Detector(path, labels="coco80"), Detector(path, "maskrcnn-zoo")):
        assert list(detector.detect(PICTURE).classes) == [61]


def test_what_is_no_detector_is_refused(tmp_path: Path) -> None:
    """A missing file, a broken one, an unknown format: one sentence each."""
    path = tmp_path / "net.onnx"
    with pytest.raises(InvalidRequest, match="path of an ONNX file"):
        Detector(path)
    path.write_bytes(b"no network")
    with pytest.raises(InvalidRequest, match="an ONNX file"):
        Detector(path)
    with pytest.raises(UnknownName, match="maskrcnn-zoo"):
        Detector(path, "maskrcnn-zoom")
    assert set(INPUTS) == {"nanodet", "centernet", "yolo", "maskrcnn", "maskrcnn-zoo"}
