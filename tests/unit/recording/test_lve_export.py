"""SAILab's stream folders: layout, motion against the pictures, classes, rate, refusals."""

from __future__ import annotations

import gzip
import io
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros import Simulation
from sailenv_ros.dataset.formats.dataset_writer import DatasetWriter
from sailenv_ros.dataset.formats.lve import lve_motion
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at

SIZE = 96

SCENE = """
version: 1
room: {size: [6, 6, 3], skirting: false}
objects:
  - {name: still cube, asset: cube, position: [1.2, 1, 0.5], static: true}
  - {name: ball, asset: sphere, position: [0, -0.6, 0.5], gravity: false, velocity: [0, 1, 0.5]}
  - {name: drum, asset: cylinder, position: [0, 0.9, 0.3], scale: 0.6, static: false}
"""

RATE_HZ = 20
STEPS = 12


def load(path: Path) -> NDArray[Any]:
    """Read an array as the streams' own reader does."""
    return np.asarray(np.load(io.BytesIO(gzip.decompress(path.read_bytes()))))


def begun(folder: Path) -> Simulation:
    """Begin the scene before its agent, the eye."""
    scene = folder / "scene.yaml"
    scene.write_text(SCENE)
    agent = AgentSpec(
        name="eye",
        intrinsics=CameraIntrinsics(width=SIZE, height=SIZE),
        pose=look_at((-2.5, 0.0, 1.2), (0.0, 0.0, 0.6)),
        following=False,
    )
    return Simulation(scene, mode="lockstep", agent=agent)


def captured(folder: Path, count: int) -> tuple[list[Frame], dict[str, Any]]:
    """Write a stream of frames; return them and the files' JSON."""
    frames = []
    with (
        begun(folder) as simulation,
        DatasetWriter(folder / "lve", ["lve"]) as writer,
    ):
        for _ in range(count):
            frames.append(simulation.capture(["rgb", "depth", "category", "instance", "flow"]))
            writer.add(frames[-1])
            simulation.step(STEPS)
        writer.finish()
    return frames, {
        name: json.loads((folder / "lve" / place).read_text())
        for name, place in (("fps", "frames/fps.json"), ("map", "sup/map.json"))
    }


@pytest.fixture(scope="module")
def stream(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Frame], dict[str, Any]]:
    folder = tmp_path_factory.mktemp("stream")
    return folder / "lve", *captured(folder, 102)


def test_the_layout_is_that_of_the_published_streams(stream: Any) -> None:
    """100 files a folder, from 001 on; the rate; classes by id, the background last."""
    folder, frames, files = stream
    assert files["fps"] == {"fps": float(RATE_HZ)}
    assert list(files["map"].values()) == list(range(len(files["map"])))
    assert list(files["map"])[-1] == "background"
    for number in (0, 99, 100, 101):
        place = f"{number // 100 + 1:08d}/{number % 100 + 1:03d}"
        picture = cv2.imread(str(folder / "frames" / f"{place}.png"))
        np.testing.assert_array_equal(picture[..., ::-1], frames[number]["rgb"])
        moved = load(folder / "motion" / f"{place}.bin")
        assert (moved.dtype, moved.shape) == (np.float32, (SIZE, SIZE, 2))
        np.testing.assert_array_equal(moved, lve_motion(frames[number]))
        targets = load(folder / "sup" / f"{place}.targets.bin")
        indices = load(folder / "sup" / f"{place}.indices.bin")
        assert targets.dtype == indices.dtype == np.int32
        np.testing.assert_array_equal(indices, np.arange(SIZE * SIZE))
        assert targets.shape == (SIZE * SIZE,)


def test_motion_leads_back_to_the_picture_before(stream: Any) -> None:
    """A warp of the picture before by (x, -y) is the present one: a fifth of the difference."""
    _, frames, _ = stream
    before, now = frames[9], frames[10]
    moved = lve_motion(now)
    moving = (moved != 0.0).any(axis=-1)
    assert moving.sum() > 100
    ball = next(i.id for i in now.info.instances if i.name == "ball")
    np.testing.assert_array_equal(moving, now["instance"] == ball)
    rows, columns = np.mgrid[:SIZE, :SIZE].astype(np.float32)
    warped = cv2.remap(
        before["rgb"], columns + moved[..., 0], rows - moved[..., 1], cv2.INTER_LINEAR
    )
    seen = moving & ~np.isnan(now["flow"]).any(axis=-1)
    error = np.abs(warped.astype(float) - now["rgb"])[seen].mean()
    unmoved = np.abs(before["rgb"].astype(float) - now["rgb"])[seen].mean()
    assert error < 0.5 * unmoved
    # The ball rises and goes to the left of the picture: back is down and to the right.
    assert moved[seen][:, 0].mean() > 0.0 > moved[seen][:, 1].mean()


def test_classes_are_those_of_what_can_move(stream: Any) -> None:
    """The static cube is background, the ball and the drum have their categories."""
    folder, frames, files = stream
    targets = load(folder / "sup" / "00000001" / "011.targets.bin").reshape(SIZE, SIZE)
    ids = frames[10]["instance"]
    for instance in frames[10].info.instances:
        name = "background" if instance.static else instance.category
        assert set(np.unique(targets[ids == instance.id])) <= {files["map"][name]}
    assert (targets != files["map"]["background"]).sum() > 100


def test_the_first_frame_has_no_motion(stream: Any) -> None:
    folder, _, _ = stream
    assert not load(folder / "motion" / "00000001" / "001.bin").any()


def test_a_single_frame_is_no_stream(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="at least two frames"):
        captured(tmp_path, 1)


def test_classes_that_come_and_go_have_one_number_each(tmp_path: Path) -> None:
    """All are numbered by their ids, whenever they are there; a writer that was ended goes on."""
    frames: list[Any] = []
    with begun(tmp_path) as simulation:
        for number in range(6):
            if number == 2:
                simulation.despawn_object("ball")
            if number == 4:
                simulation.spawn_object(
                    "cube", (0, -0.6, 0.5), scale=0.5, category="cup", mass_kg=1.0
                )
            frames.append(simulation.capture(["rgb", "category", "instance", "flow"]))
            simulation.step(STEPS)
    writer = DatasetWriter(tmp_path / "lve", ["lve"])
    for frame in frames[:3]:
        writer.add(frame)
    writer.close()
    with DatasetWriter(tmp_path / "lve", ["lve"], resume=True) as writer:
        for frame in frames[3:]:
            writer.add(frame)
        writer.finish()
    names = json.loads((tmp_path / "lve" / "sup" / "map.json").read_text())
    categories = frames[0].info.categories
    moving = {i.category for frame in frames for i in frame.info.instances if not i.static}
    by_id = sorted(moving, key=lambda name: categories.named(name).id)
    assert list(names.items()) == [(name, n) for n, name in enumerate([*by_id, "background"])]
    for number, frame in enumerate(frames):
        targets = load(tmp_path / "lve" / "sup" / "00000001" / f"{number + 1:03d}.targets.bin")
        expected = np.full(frame["instance"].shape, names["background"])
        for instance in frame.info.instances:
            if not instance.static:
                expected[frame["instance"] == instance.id] = names[instance.category]
        np.testing.assert_array_equal(targets.reshape(expected.shape), expected)
    assert not list(tmp_path.rglob("*.unfinished"))
