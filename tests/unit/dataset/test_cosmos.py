"""Videos that control a video model: clips, controls by their formulas, captions."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from sailenv_ros import Simulation
from sailenv_ros.dataset.formats import DatasetWriter
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

SIZE = (97, 64)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[list[Frame]]]:
    """Two clips of five and three frames, from before and after a reset."""
    folder = tmp_path_factory.mktemp("cosmos")
    eye = AgentSpec(
        name="eye",
        intrinsics=CameraIntrinsics(width=SIZE[0], height=SIZE[1], vertical_fov_deg=60.0),
        views=("rgb", "depth", "instance"),
    )
    clips: list[list[Frame]] = []
    with (
        Simulation("object_view", mode="lockstep", agent=eye) as simulation,
        DatasetWriter(folder, ["cosmos"]) as writer,
    ):
        for count in (5, 3):
            clips.append([])
            for _ in range(count):
                clips[-1].append(simulation.capture())
                writer.add(clips[-1][-1])
                simulation.step(24)
            simulation.reset()
        writer.finish()
    return folder, clips


def _pictures(path: Path) -> tuple[list[Any], float]:
    video = cv2.VideoCapture(str(path))
    found = []
    while True:
        there, picture = video.read()
        if not there:
            break
        found.append(picture[..., ::-1].astype(np.int64))
    return found, video.get(cv2.CAP_PROP_FPS)


@pytest.mark.parametrize("clip", [0, 1])
def test_each_epoch_is_a_clip(made: tuple[Path, list[list[Frame]]], clip: int) -> None:
    """At the rate of its frames; an odd column is left out; there are no drafts."""
    folder, clips = made
    for name in ("videos", "depth", "seg", "edge", "vis"):
        pictures, rate = _pictures(folder / name / f"{clip:04d}.mp4")
        assert len(pictures) == len(clips[clip])
        assert pictures[0].shape == (64, 96, 3)
        assert rate == pytest.approx(10.0)
    caption = (folder / "metas" / f"{clip:04d}.txt").read_text()
    assert caption.startswith("A room with ")
    assert not list(folder.rglob(".*"))


def test_controls_show_the_frame(made: tuple[Path, list[list[Frame]]]) -> None:
    """As well as the codec keeps them: depth as grey by its inverse, edges white on black."""
    folder, clips = made
    frame = clips[0][0]
    (depth, *_), _ = _pictures(folder / "depth" / "0000.mp4")
    inverse = 1.0 / np.nan_to_num(frame["depth"][:, :96].astype(np.float64), posinf=1e9)
    expected = 255.0 * ((inverse - 1 / 12.0) / (1 / 0.4 - 1 / 12.0)).clip(0.0, 1.0)
    assert np.abs(depth[..., 1] - expected).mean() < 3.0
    (edges, *_), _ = _pictures(folder / "edge" / "0000.mp4")
    canny = cv2.Canny(np.ascontiguousarray(frame["rgb"]), 100, 200)[:, :96]
    assert edges[canny == 255].mean() > 120.0 > 40.0 > edges[canny == 0].mean()
    (plain, *_), _ = _pictures(folder / "videos" / "0000.mp4")
    (blurred, *_), _ = _pictures(folder / "vis" / "0000.mp4")
    rgb = np.ascontiguousarray(frame["rgb"])
    smooth = cv2.GaussianBlur(rgb, (0, 0), 0.02 * 64)
    for shown, kept in ((plain, rgb), (blurred, smooth)):
        assert np.abs(shown - kept[:, :96].astype(np.int64)).mean() < 6.0
    (segments, *_), _ = _pictures(folder / "seg" / "0000.mp4")
    ids = frame["instance"][:, :96]
    inside = ids == np.argmax(np.bincount(ids.ravel()))
    assert segments[inside].std(axis=0).max() < 30.0


def test_masks_of_a_clip_are_its_ids(made: tuple[Path, list[list[Frame]]]) -> None:
    """One column of all pixels for each object, as the COCO API decodes it."""
    folder, clips = made
    ids = np.stack([frame["instance"][:, :96] for frame in clips[1]])
    info = clips[1][0].info
    assert info is not None
    names = {one.id: one.category.replace("_", " ") for one in info.instances}
    entries = pickle.loads((folder / "seg" / "0001.pickle").read_bytes())
    seen = sorted({*np.unique(ids).tolist()} - {0})
    assert [entry["phrase"] for entry in entries] == [names[id_] for id_ in seen]
    for id_, entry in zip(seen, entries, strict=True):
        mask = entry["segmentation_mask_rle"]
        assert mask["mask_shape"] == [3, 64, 96]
        assert mask["data"]["size"] == [ids.size, 1]
        lengths = _lengths(mask["data"]["counts"].decode())
        decoded = np.repeat(np.arange(len(lengths)) % 2, lengths).reshape(ids.shape)
        assert (decoded == (ids == id_)).all()


def _lengths(text: str) -> list[int]:
    """Return run lengths, as rleFrString of the COCO API does."""
    lengths: list[int] = []
    value = shift = 0
    for letter in text:
        bits = ord(letter) - 48
        value |= (bits & 0x1F) << shift
        shift += 5
        if not bits & 0x20:
            value -= (1 << shift) if bits & 0x10 else 0
            lengths.append(value + (lengths[-2] if len(lengths) > 2 else 0))
            value = shift = 0
    return lengths


def test_inference_is_told_of_each_clip(made: tuple[Path, list[list[Frame]]]) -> None:
    folder, _ = made
    for clip in ("0000", "0001"):
        spec = json.loads((folder / "specs" / f"{clip}.json").read_text())
        assert spec["prompt"] == (folder / "metas" / f"{clip}.txt").read_text().strip()
        files = [spec["input_video_path"]]
        files += [spec[name]["input_control"] for name in ("depth", "seg", "edge", "vis")]
        assert all((folder / file).is_file() for file in files)
