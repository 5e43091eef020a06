"""Sheets and pages of data sets: what they hold, what they refuse."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from sailenv_ros.cli.main import main
from sailenv_ros.dataset import open_dataset
from sailenv_ros.dataset.content_counts import content_counts
from sailenv_ros.dataset.preview_page import _outline as outline
from sailenv_ros.dataset.preview_page import preview_html
from sailenv_ros.dataset.showing import save_sheet
from sailenv_ros.errors import RecordingError, UnknownName


def test_a_page_tells_what_is_in_the_frames(small: Path, tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    assert main(["dataset", "show", str(small), "-o", str(path), "--split", "val"]) == 0
    page = path.read_text()
    told = json.loads(re.search(r'id="told">(.*?)</script>', page, re.S)[1])  # type: ignore[index]
    assert told["views"] == ["rgb", "depth", "category", "instance", "flow"]
    assert {one["name"]: one["count"] for one in told["splits"]} == {"train": 30, "val": 12}
    assert {one["split"] for one in told["frames"]} == {"val"}
    with open_dataset(small, "val") as dataset:
        for one, frame in zip(told["frames"], dataset, strict=True):
            assert (one["number"], one["camera"]) == (frame.number, frame.camera)
            assert sorted(each["pixels"] for each in one["objects"]) == sorted(
                each["visible_pixels"] for each in frame.objects
            )


def test_a_page_lies_in_its_data_set(small: Path, tmp_path: Path) -> None:
    """Where no other file is named; it is none of the data set's files."""
    copy = tmp_path / "copy"
    shutil.copytree(small, copy)
    assert main(["dataset", "show", str(copy), "--frames", "2"]) == 0
    assert "<html" in (copy / "dataset.html").read_text()
    assert main(["dataset", "verify", str(copy), "--shards", "0"]) == 0


@pytest.mark.parametrize("seed", range(4))
def test_outlines_enclose_what_is_visible(seed: int) -> None:
    random = np.random.default_rng(seed)
    blobs = cv2.GaussianBlur(random.random((90, 120)).astype(np.float32), (0, 0), 6.0) > 0.5
    instance = np.where(blobs, 7, 3).astype(np.uint16)
    rows, columns = np.nonzero(blobs)
    box = [columns.min(), rows.min(), columns.max(), rows.max()]
    path = outline(instance, {"id": 7, "box": [int(edge) for edge in box]})
    contours = [
        np.array([[int(value) for value in corner.split()] for corner in part.split("L")])
        for part in re.findall(r"M([^Z]*)Z", path)
    ]
    filled = np.zeros(blobs.shape, np.uint8)
    cv2.fillPoly(filled, contours, 1)
    assert (filled.astype(bool) != blobs).mean() < 0.03


def test_a_sheet_has_a_row_for_each_frame(small: Path, tmp_path: Path) -> None:
    path = tmp_path / "sheet.png"
    assert save_sheet(small, path, frames=3) == 3
    sheet = cv2.imread(str(path))
    assert sheet is not None
    assert sheet.shape[1] > sheet.shape[0]


def test_what_is_not_there_is_refused(small: Path, tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no such folder"):
        save_sheet(tmp_path / "none", tmp_path / "sheet.png")
    assert main(["dataset", "show", str(tmp_path / "none"), "-o", str(tmp_path / "a.html")]) != 0
    with pytest.raises(UnknownName, match="test"), open_dataset(small, "test") as dataset:
        preview_html(dataset, [0])
    assert not list(tmp_path.iterdir())


def test_counts_are_of_bins_and_of_frames() -> None:
    found = content_counts(
        [
            {
                "split": "train",
                "scene": "a",
                "objects": [["bed", 20, 0.95, 1.2], ["bed", 1, None, None]],
            },
            {"split": "val", "scene": "a", "objects": []},
        ]
    )
    assert found.frames == {"train": 1, "val": 1}
    assert found.objects == {"bed": 2}
    assert found.frames_with == {"bed": 1}
    assert found.sizes == {0: 1, 1: 1}
    assert found.shares == {9: 1}
    assert found.distances == {2: 1}
    assert set(found.histograms()) == {"sizes", "visible_shares", "distances"}
