"""Data sets of motion, read back by their own formulas and held against `motion` and `track`."""

from __future__ import annotations

import itertools
import json
import pickle
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest

from sailenv_ros.dataset.formats import export
from sailenv_ros.dataset.formats.dataset_writer import DatasetWriter
from sailenv_ros.dataset.formats.movi import lens_arrays, lens_of, load_movi_frame
from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import SceneGeometry, motion, track
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.lockstep import record_lockstep
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from tests.support.picture import read_picture as read
from tests.support.recordings import write_noise

pytestmark = [pytest.mark.ros, pytest.mark.gl]

COUNT = 4
VIEWS = ("rgb", "depth", "instance")


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, list[Frame]]]:
    """A few frames of moving cubes before a moving camera, also as they were recorded."""
    folder = tmp_path_factory.mktemp("moving") / "bag"
    lens = CameraIntrinsics(width=96, height=64)
    spec = AgentSpec(name="eye", intrinsics=lens, rate_hz=10.0)
    with Simulation("optical", mode="lockstep", agent=spec) as simulation:
        with RecordingWriter(folder) as writer:
            views = (*VIEWS, "scene_flow", "flow_forward")
            record_lockstep(simulation, writer, frames=COUNT, agents=["eye"], views=views)
        with RecordingReader(folder) as reader:
            yield folder, list(RecordedFrames(reader, "eye"))


def kitti_flow(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return flow and validity as KITTI's development kit reads them."""
    u, v, valid = np.moveaxis(read(path)[..., ::-1].astype(np.float64), -1, 0)
    return np.stack([(u - 2**15) / 64, (v - 2**15) / 64], -1), valid > 0


def test_frames_of_lockstep_have_their_motion_to_the_next(bag: tuple[Path, list[Frame]]) -> None:
    """As views that were recorded with them; the last one has none."""
    _, frames = bag
    for one, other in itertools.pairwise(frames):
        moved = motion(one, other)
        np.testing.assert_array_equal(one["flow_forward"], moved.flow)
        np.testing.assert_array_equal(one["scene_flow"], moved.scene_flow)
        assert np.nanmax(np.abs(moved.flow)) > 0.1
        assert moved.visible.mean() > 0.8
    assert np.isnan(frames[-1]["flow_forward"]).all()


def test_kitti_is_forward_flow_with_and_without_occluded_pixels(
    bag: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """Pairs of pictures, flow in steps of 1/64 px, depth in steps of 1/256 m; backward if asked."""
    path, frames = bag
    summary = export(path, tmp_path / "out", ["kitti"], agent="eye", flow="both")
    assert summary.formats["kitti"].written == {
        "pictures": 2 * (COUNT - 1),
        "depth maps": COUNT,
        "flow fields": 2 * (COUNT - 1),
    }
    assert list(summary.formats["kitti"].left_out.values()) == [1]
    for number, (one, other) in enumerate(itertools.pairwise(frames)):
        first, last = (f"{number:06d}_1{end}.png" for end in (0, 1))
        assert (read(tmp_path / "out/image_2" / first)[..., ::-1] == one["rgb"]).all()
        assert (read(tmp_path / "out/image_2" / last)[..., ::-1] == other["rgb"]).all()
        depth = read(tmp_path / "out/depth" / first) / 256
        there = np.isfinite(one["depth"])
        assert np.abs(depth - one["depth"])[there].max() <= 1 / 512 + 1e-9
        for folder, name, moved in (
            ("flow", first, motion(one, other)),
            ("flow_backward", last, motion(other, one)),
        ):
            flow, valid = kitti_flow(tmp_path / f"out/{folder}_occ" / name)
            assert (valid == moved.valid).all()
            assert np.abs(flow - moved.flow)[valid].max() <= 1 / 128 + 1e-4
            _, seen = kitti_flow(tmp_path / f"out/{folder}_noc" / name)
            assert (seen == moved.visible).all()
    # Readers match pictures by their order: there are none without the other of their pair.
    names = sorted(file.name for file in (tmp_path / "out/image_2").iterdir())
    assert names == [f"{number:06d}_1{end}.png" for number in range(COUNT - 1) for end in (0, 1)]


def test_sintel_is_forward_flow_with_its_masks(
    bag: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """One flow less than pictures; masks of what is unmatched, leaves, or has none."""
    path, frames = bag
    export(path, tmp_path / "out", ["sintel"], agent="eye")
    scene = "optical_1"
    pictures = sorted((tmp_path / "out/clean" / scene).iterdir())
    flows = sorted((tmp_path / "out/flow" / scene).iterdir())
    assert [file.name for file in pictures] == [f"frame_{k:04d}.png" for k in range(1, COUNT + 1)]
    assert [file.stem for file in flows] == [file.stem for file in pictures[:-1]]
    for number, flow in enumerate(flows):
        moved = motion(frames[number], frames[number + 1])
        values = cv2.readOpticalFlow(str(flow))
        assert (values[moved.valid] == moved.flow[moved.valid]).all()
        assert (values[~moved.valid] > 1e9).all()
        for mask, expected in (
            ("occlusions", moved.occluded | moved.out_of_view),
            ("outofframe", moved.out_of_view),
            ("invalid", ~moved.valid),
        ):
            found = read(tmp_path / "out" / mask / scene / f"{flow.stem}.png")
            assert ((found == 255) == expected).all()
    assert not (tmp_path / "out/flow_backward").exists()


def test_movi_files_are_frames_again(bag: tuple[Path, list[Frame]], tmp_path: Path) -> None:
    """Motion between exported frames is that between the recorded ones, bit by bit."""
    path, frames = bag
    export(path, tmp_path / "out", ["movi"], agent="eye")
    again = [load_movi_frame(tmp_path / f"out/{number:06d}.npz") for number in range(COUNT)]
    for one, other in ((0, 1), (0, 3), (3, 1)):
        expected, got = motion(frames[one], frames[other]), motion(again[one], again[other])
        for name in ("flow", "scene_flow", "valid", "occluded", "out_of_view"):
            assert getattr(got, name).tobytes() == getattr(expected, name).tobytes()
    with np.load(tmp_path / "out/000001.npz") as arrays:
        forward, backward = (arrays[f"{name}_flow"] for name in ("forward", "backward"))
        moved = motion(frames[1], frames[2])
        np.testing.assert_array_equal(forward[..., ::-1], moved.flow)
        # Kubric's backward flow points the way the surface moved, as its forward flow does.
        before = motion(frames[1], frames[0])
        np.testing.assert_array_equal(-backward[..., ::-1], before.flow)
        assert (arrays["quaternions"][:, 0] == frames[1].states.orientations[:, 3]).all()  # type: ignore[union-attr]
        assert np.isfinite(arrays["object_coordinates"][frames[1]["instance"] > 0]).all()
    (tmp_path / "broken.npz").write_bytes(b"PK\x03\x04 cut off")
    with pytest.raises(RecordingError, match="no frame of the format movi"):
        load_movi_frame(tmp_path / "broken.npz")


LENSES = [
    CameraIntrinsics(width=96, height=64),
    CameraIntrinsics(width=96, height=64, cy_offset_px=3.25),
    CameraIntrinsics(width=96, height=64, fx_px=70.5, fy_px=60.25, cx_offset_px=-2.5),
    CameraIntrinsics(fx_px=300.0, fy_px=310.0, max_angle_deg=50.0),
    CameraIntrinsics(
        vertical_fov_deg=150.0,
        max_angle_deg=100.0,
        distortion_model="equidistant",
        distortion=(0.01, 0.0, -0.001, 0.0),
    ),
]


@pytest.mark.parametrize("lens", LENSES)
def test_movi_files_keep_the_lens(lens: CameraIntrinsics, tmp_path: Path) -> None:
    """Of any kind; a plain one is written as it always was."""
    np.savez(tmp_path / "one.npz", **lens_arrays(lens))
    with np.load(tmp_path / "one.npz", allow_pickle=False) as arrays:
        assert lens_of(dict(arrays)) == lens
        if lens == LENSES[0]:
            assert arrays.files == ["lens"]
            assert arrays["lens"].tolist() == [96.0, 64.0, 60.0, 0.05, 100.0]


@pytest.mark.parametrize("lens", [LENSES[2], replace(LENSES[4], width=96, height=64)])
def test_a_recording_and_its_exports_keep_the_lens(lens: CameraIntrinsics, tmp_path: Path) -> None:
    """Focal lengths, model, coefficients, image circle."""
    spec = AgentSpec(name="eye", intrinsics=lens, rate_hz=10.0)
    with (
        Simulation("optical", mode="lockstep", agent=spec) as simulation,
        RecordingWriter(tmp_path / "bag") as writer,
    ):
        record_lockstep(simulation, writer, frames=1, agents=["eye"], views=VIEWS)
    with RecordingReader(tmp_path / "bag") as reader:
        (frame,) = RecordedFrames(reader, "eye")
    assert frame.camera.intrinsics == lens
    export(tmp_path / "bag", tmp_path / "out", ["png", "coco", "parquet"], agent="eye")
    (record,) = json.loads((tmp_path / "out/png/frames.json").read_text())
    (image,) = json.loads((tmp_path / "out/coco/annotations.json").read_text())["images"]
    (row,) = pq.read_table(tmp_path / "out/parquet/data").to_pylist()
    for told in (record, image, row):
        assert np.reshape(told["K"], (3, 3)).tolist() == lens.K.tolist()
        if not lens.is_pinhole:
            assert told["distortion_model"] == lens.distortion_model
            assert told["D"] == list(lens.distortion)
            assert told["max_angle_deg"] == lens.max_angle_deg


def test_tapvid_points_are_tracks_in_raster_coordinates(
    bag: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """Videos by name; a point is where `track` says, with the picture's corner as origin."""
    path, frames = bag
    export(path, tmp_path / "out", ["tapvid"], agent="eye")
    videos = pickle.loads((tmp_path / "out/tapvid.pkl").read_bytes())
    (entry,) = videos.values()
    assert entry["video"].shape == (COUNT, 64, 96, 3)
    assert (entry["video"][2] == frames[2]["rgb"]).all()
    points, occluded = entry["points"], entry["occluded"]
    assert points.shape == (*occluded.shape, 2)
    assert (points.dtype, occluded.dtype) == (np.float32, np.bool_)
    assert occluded.any()
    assert (~occluded).all(axis=1).any()
    seen = points[~occluded]
    assert seen.min() >= 0.0
    assert seen.max() <= 1.0
    with Simulation("optical", mode="lockstep") as simulation:
        geometry = SceneGeometry.of_contents(simulation.contents)
    first = np.flatnonzero(~occluded[:, 0])
    pixels = points[first, 0].astype(np.float64) * (96, 64) - 0.5
    queries = np.concatenate([np.zeros((len(first), 1)), pixels], axis=1)
    tracks = track(queries, frames, geometry)
    together = (tracks.visible & ~occluded[first])[:, 1:]
    expected = tracks.pixels[:, 1:][together]
    found = points[first, 1:][together].astype(np.float64) * (96, 64) - 0.5
    # A point that is rounded to single precision may be another surface's at an edge.
    assert np.quantile(np.abs(found - expected), 0.99) < 0.01


def test_an_export_of_neighbours_goes_on_where_it_was_broken_off(
    bag: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """After each number of frames: the same files as without a break."""
    _, frames = bag
    formats = ["sintel", "kitti", "movi"]
    with DatasetWriter(tmp_path / "whole", formats, flow="both") as writer:
        for frame in frames:
            writer.add(frame)
    whole = files_of(tmp_path / "whole")
    for taken in range(COUNT + 1):
        folder = tmp_path / f"broken {taken}"
        writer = DatasetWriter(folder, formats, flow="both")
        for frame in frames[:taken]:
            writer.add(frame)
        writer.close()
        with DatasetWriter(folder, formats, flow="both", resume=True) as writer:
            assert writer.done <= taken
            for frame in frames[writer.done :]:
                writer.add(frame)
        assert files_of(folder) == whole
    with pytest.raises(InvalidRequest, match="forward, backward, both"):
        DatasetWriter(tmp_path / "wrong", formats, flow="sideways")  # type: ignore[arg-type]


def files_of(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def test_what_was_not_recorded_is_left_out_or_refused(tmp_path: Path) -> None:
    """KITTI without depth has no flow, and says so; TAP-Vid of no known scene is an error."""
    write_noise(tmp_path / "bag", 2, views=("rgb", "flow"))
    summary = export(tmp_path / "bag", tmp_path / "kitti", ["kitti"])
    written = {"pictures": 2, "depth maps": 0, "flow fields": 0}
    assert summary.formats["kitti"].written == written
    assert len(summary.formats["kitti"].left_out) == 2
    with pytest.raises(InvalidRequest, match="views that sintel needs"):
        export(tmp_path / "bag", tmp_path / "sintel", ["sintel"])
