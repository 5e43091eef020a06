"""Data sets read back by other readers: OpenCV, pycocotools."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from pycocotools import mask as coco_mask
from pycocotools.coco import COCO

from sailenv_ros.cli.main import main
from sailenv_ros.dataset.formats import FORMATS, export
from sailenv_ros.dataset.formats.coco_rle import run_lengths_text
from sailenv_ros.errors import InvalidRequest, UnknownName, WriteFailed
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.run_lengths import run_lengths
from sailenv_ros.types.views import VIEWS
from tests.support.picture import read_picture as read
from tests.support.recordings import write_noise

pytestmark = pytest.mark.ros

COUNT = 3
VIEWS_HERE = tuple(view for view in VIEWS if view != "normals")


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Frame]]:
    folder = tmp_path_factory.mktemp("exported") / "bag"
    return folder, write_noise(folder, COUNT, views=VIEWS_HERE)


def test_png_views_are_the_frames_values(bag: tuple[Path, list[Frame]], tmp_path: Path) -> None:
    """Colours and ids exactly, depth to half a millimetre, 0 where there is none."""
    path, frames = bag
    assert export(path, tmp_path / "out", ["png"]).frames == COUNT
    for number, frame in enumerate(frames):
        name = f"{number:06d}.png"
        assert (read(tmp_path / "out/rgb" / name)[..., ::-1] == frame["rgb"]).all()
        assert (read(tmp_path / "out/category" / name) == frame["category"]).all()
        instance = read(tmp_path / "out/instance" / name)
        assert instance.dtype == np.uint16
        assert (instance == frame["instance"]).all()
        assert ((read(tmp_path / "out/occlusion" / name) > 0) == frame["occlusion"]).all()
        depth = read(tmp_path / "out/depth" / name).astype(np.float64)
        there = (frame["depth"] >= 0.001) & (frame["depth"] < 65.535)
        assert np.abs(depth[there] * 1e-3 - frame["depth"][there]).max() <= 0.0005001
        assert (depth[~(frame["depth"] > 0.0005)] == 0).all()
        assert (depth[frame["depth"] > 65.536] == 0).all()
    records = json.loads((tmp_path / "out/frames.json").read_text())
    assert [record["stamp_ns"] for record in records] == [frame.stamp_ns for frame in frames]
    assert records[1]["K"] == frames[1].camera.intrinsics.K.tolist()


# pycocotools' own, with NumPy 2.
@pytest.mark.filterwarnings("ignore:__array__ implementation doesn't accept:DeprecationWarning")
def test_pycocotools_reads_the_annotations(bag: tuple[Path, list[Frame]], tmp_path: Path) -> None:
    """Every mask, box, area and category is that of the instance view."""
    path, frames = bag
    export(path, tmp_path / "out", ["coco"])
    with contextlib.redirect_stdout(io.StringIO()):
        coco = COCO(str(tmp_path / "out/annotations.json"))
    assert {c["name"] for c in coco.loadCats(coco.getCatIds())} == {"chair", "lamp"}
    assert coco.getImgIds() == list(range(COUNT))
    for number, frame in enumerate(frames):
        image = coco.loadImgs([number])[0]
        picture = read(tmp_path / "out/images" / image["file_name"])
        assert (picture[..., ::-1] == frame["rgb"]).all()
        annotations = coco.loadAnns(coco.getAnnIds(imgIds=[number]))
        assert {a["instance_id"]: a["category_id"] for a in annotations} == {1: 3, 2: 9}
        for annotation in annotations:
            mask = coco.annToMask(annotation).astype(bool)
            assert (mask == (frame["instance"] == annotation["instance_id"])).all()
            encoded = coco.annToRLE(annotation)
            assert coco_mask.area(encoded) == annotation["area"]
            assert coco_mask.toBbox(encoded).tolist() == annotation["bbox"]


def long_runs(width: int) -> np.ndarray:
    """A mask whose runs have lengths of several letters, and differences below zero."""
    mask = np.zeros((200, width), bool)
    mask[30:170, 20:-20] = True
    mask[100] = False
    return mask


@given(mask=arrays.arrays(np.bool_, st.tuples(st.integers(1, 40), st.integers(1, 40))))
@example(mask=long_runs(100))
@example(mask=long_runs(3000))
def test_run_lengths_are_those_of_pycocotools(mask: np.ndarray) -> None:
    """Letter for letter what the reference encodes."""
    expected = coco_mask.encode(np.asfortranarray(mask.astype(np.uint8)))["counts"]
    assert run_lengths_text(run_lengths(mask)).encode() == expected


def test_flo_files_are_read_by_opencv(bag: tuple[Path, list[Frame]], tmp_path: Path) -> None:
    """The displacement to the frame before, unknown where there is none."""
    path, frames = bag
    export(path, tmp_path / "out", ["flo"])
    for number, frame in enumerate(frames):
        read_flow = cv2.readOpticalFlow(str(tmp_path / f"out/{number:06d}.flo"))
        expected = frame["flow"] * np.float32(-frame.dt_s)
        known = np.isfinite(expected)
        assert (read_flow[known] == expected[known]).all()
        assert (read_flow[~known] > 1e9).all()


def test_the_preview_is_a_video_of_all_frames(
    bag: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """OpenCV opens it, at the frames' rate, with as many pictures."""
    path, _ = bag
    export(path, tmp_path / "out", ["mp4"])
    video = cv2.VideoCapture(str(tmp_path / "out/preview.mp4"))
    count = 0
    while video.read()[0]:
        count += 1
    assert count == COUNT
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(30.0, rel=0.01)
    assert video.get(cv2.CAP_PROP_FRAME_WIDTH) == 3 * 32
    video.release()


def test_the_command_exports_several_formats(
    bag: tuple[Path, list[Frame]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`sailenv export` gives each of several formats a folder, and overwrites nothing."""
    path, _ = bag
    out = tmp_path / "out"
    words = ["export", str(path), "-o", str(out), "--format"]
    # The scene of noise has neither geometry to follow points in nor amodal masks.
    formats = [name for name in FORMATS if name not in ("tapvid", "bop")]
    assert main([*words, *formats]) == 0
    assert f"{COUNT} frames as {', '.join(formats)}" in capsys.readouterr().out
    assert sorted(path.name for path in out.iterdir()) == sorted(["export.json", *formats])
    assert main([*words, "png"]) == 2
    assert "is not empty; nothing is overwritten" in capsys.readouterr().err


def test_what_cannot_be_exported_is_refused(tmp_path: Path) -> None:
    """Unknown formats, no format, and formats whose views were not recorded."""
    write_noise(tmp_path / "bag", 1, views=("rgb",))
    with pytest.raises(UnknownName, match="'coco'"):
        export(tmp_path / "bag", tmp_path / "out", ["cocoa"])
    with pytest.raises(InvalidRequest, match="at least one of"):
        export(tmp_path / "bag", tmp_path / "out", [])
    with pytest.raises(InvalidRequest, match="flo needs: flow"):
        export(tmp_path / "bag", tmp_path / "out", ["flo"])
    assert not (tmp_path / "out").exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteFailed, match="file/out cannot be written: Not a directory"):
        export(tmp_path / "bag", tmp_path / "file/out", ["png"])
