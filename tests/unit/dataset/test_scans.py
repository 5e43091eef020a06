"""Folders as readers of scanned rooms have them: lenses, poses, depth and labels, read plainly."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.dataset import engine_of, load_job, make_dataset
from sailenv_ros.dataset.formats import DatasetWriter
from sailenv_ros.dataset.formats.formats import FORMATS
from sailenv_ros.dataset.formats.splits import Splits
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.row_poses import RowPoses
from tests.unit.dataset.conftest import SMALL, written_recipe

SCENE = """
version: 1
settled: false
objects:
  - {name: ground, asset: plane, static: true, category: floor}
  - {name: box, asset: cube, category: bed, position: [2.5, 0.3, 0.5], static: true}
"""
VIEWS = ("rgb", "depth", "category", "instance", "normals")
EYES = ((0.0, 0.0, 1.0), (0.4, 1.0, 1.4))
POSED = ("colmap", "nerfstudio", "instant-ngp", "3dgs", "scannet", "replica", "hypersim")


@pytest.fixture(scope="module")
def taken(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    scene = tmp_path_factory.mktemp("box") / "box.yaml"
    scene.write_text(SCENE)
    lens = CameraIntrinsics(width=64, height=48)
    spec = AgentSpec(name="eye", intrinsics=lens, views=VIEWS, following=False)
    frames = []
    with Simulation(scene, mode="lockstep", agent=spec) as simulation:
        for eye in EYES:
            simulation.set_pose(look_at(eye, (2.5, 0.0, 0.4)))
            frames.append(simulation.capture())
    return frames


@pytest.fixture(scope="module")
def written(taken: list[Frame], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("written") / "all"
    with DatasetWriter(folder, POSED) as writer:
        for frame in taken:
            writer.add(frame)
    return folder


def seen(frame: Frame, row: int, column: int, depth: float) -> NDArray[np.float64]:
    """Return the place in the world that a pixel of a pin-hole sees at a depth."""
    lens, pose = frame.camera.intrinsics, frame.camera.world_from_camera
    ray = ((column - lens.cx) / lens.fx, (row - lens.cy) / lens.fy, 1.0)
    return np.asarray(pose[:3, :3] @ (depth * np.array(ray)) + pose[:3, 3])


def picture(path: Path) -> NDArray[np.uint16]:
    found = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert found is not None
    return np.asarray(found)


def test_scannet_s_folders(written: Path, taken: list[Frame]) -> None:
    folder = written / "scannet"
    camera = np.loadtxt(folder / "intrinsic" / "intrinsic_color.txt")
    np.testing.assert_array_equal(camera[:3, :3], taken[0].camera.intrinsics.K)
    for number, frame in enumerate(taken):
        pose = np.loadtxt(folder / "pose" / f"{number}.txt")
        np.testing.assert_array_equal(pose, frame.camera.world_from_camera)
        depth = picture(folder / "depth" / f"{number}.png")
        assert abs(depth[40, 30] / 1000.0 - frame["depth"][40, 30]) <= 5e-4
        labels = picture(folder / "label-filt" / f"{number}.png")
        np.testing.assert_array_equal(labels, frame["category"])
        ids = picture(folder / "instance-filt" / f"{number}.png")
        np.testing.assert_array_equal(ids, frame["instance"])
        colour = picture(folder / "color" / f"{number}.jpg")[..., ::-1]
        assert np.abs(colour.astype(int) - frame["rgb"]).mean() < 3.0
    rows = (folder / "scannetv2-labels.combined.tsv").read_text().splitlines()
    table = [dict(zip(rows[0].split("\t"), row.split("\t"), strict=True)) for row in rows[1:]]
    nyu = {row["raw_category"]: (row["nyu40id"], row["nyu40class"]) for row in table}
    assert nyu["bed"] == ("4", "bed")
    assert nyu["nightstand"] == ("32", "night stand")


def test_replica_s_files(written: Path, taken: list[Frame]) -> None:
    folder = written / "replica"
    poses = np.loadtxt(folder / "traj.txt").reshape(-1, 4, 4)
    for number, (frame, pose) in enumerate(zip(taken, poses, strict=True)):
        np.testing.assert_array_equal(pose, frame.camera.world_from_camera)
        depth = picture(folder / "results" / f"depth{number:06d}.png") / 6553.5
        assert abs(depth[40, 30] - frame["depth"][40, 30]) <= 1e-4
        assert (folder / "results" / f"frame{number:06d}.jpg").is_file()
    camera = json.loads((folder / "cam_params.json").read_text())["camera"]
    assert camera["scale"] == 6553.5
    assert (camera["fx"], camera["cx"]) == (
        taken[0].camera.intrinsics.fx, taken[0].camera.intrinsics.cx,
    )  # fmt: skip


def hdf5(path: Path) -> np.ndarray:
    with h5py.File(path) as file:
        return file["dataset"][:]


def test_hypersim_s_distances_and_poses(written: Path, taken: list[Frame]) -> None:
    images, detail = written / "hypersim" / "images", written / "hypersim" / "_detail" / "cam_00"
    frame = taken[1]
    geometry = images / "scene_cam_00_geometry_hdf5"
    distance = hdf5(geometry / "frame.0001.depth_meters.hdf5")
    assert distance.shape == (48, 64)
    at = seen(frame, 40, 30, float(frame["depth"][40, 30]))
    eye = frame.camera.world_from_camera[:3, 3]
    assert distance[40, 30] == pytest.approx(np.linalg.norm(at - eye), rel=1e-6)
    places = hdf5(geometry / "frame.0001.position.hdf5")
    np.testing.assert_allclose(places[40, 30], at, rtol=1e-5)
    semantic = hdf5(geometry / "frame.0001.semantic.hdf5")
    names = {one.id: one.name for one in frame.info.instances} if frame.info else {}
    assert {names[i] for i in np.unique(frame["instance"][semantic == 4])} == {"box"}
    turns = hdf5(detail / "camera_keyframe_orientations.hdf5")
    pose = frame.camera.world_from_camera
    np.testing.assert_array_equal(turns[1], pose[:3, :3] * (1.0, -1.0, -1.0))
    table = (detail.parent / "metadata_camera_parameters.csv").read_text().splitlines()
    told = dict(zip(*(line.split(",") for line in table), strict=True))
    rays = np.array([float(told[f"M_cam_from_uv_{row}{k}"]) for row in range(3) for k in range(3)])
    ray = turns[1] @ rays.reshape(3, 3) @ (2.0 * 30.5 / 64 - 1.0, 1.0 - 2.0 * 40.5 / 48, 1.0)
    np.testing.assert_allclose(ray * frame["depth"][40, 30] + eye, at, rtol=1e-6)


def test_instant_ngp_s_cube_and_depth(written: Path, taken: list[Frame]) -> None:
    table = json.loads((written / "instant-ngp" / "transforms.json").read_text())
    other = json.loads((written / "nerfstudio" / "transforms.json").read_text())
    low, high = np.array(table["aabb"])
    for frame, entry, same in zip(taken, table["frames"], other["frames"], strict=True):
        eye = frame.camera.world_from_camera[:3, 3]
        assert ((low <= eye) & (eye <= high)).all()
        assert entry["transform_matrix"] == same["transform_matrix"]
        depth = picture(written / "instant-ngp" / entry["depth_path"])
        off = depth[40, 30] * table["integer_depth_scale"] - frame["depth"][40, 30]
        assert abs(off) <= 5e-4
    assert "aabb" not in other


def test_gaussians_inverse_depth(written: Path, taken: list[Frame]) -> None:
    folder = written / "3dgs"
    told = json.loads((folder / "sparse" / "0" / "depth_params.json").read_text())
    steps = picture(folder / "depths" / "000001.png")
    inverse = steps / 65536 * told["000001"]["scale"] + told["000001"]["offset"]
    assert inverse[40, 30] == pytest.approx(1.0 / taken[1]["depth"][40, 30], abs=1e-4)
    models = [(written / name / "sparse" / "0" / "points3D.txt").read_bytes()
              for name in ("3dgs", "colmap")]  # fmt: skip
    assert models[0] == models[1] != b""


def test_what_a_format_cannot_hold_is_refused(taken: list[Frame], tmp_path: Path) -> None:
    frame = taken[0]
    poses = np.repeat(frame.camera.world_from_camera[None], 48, axis=0)
    rolled = replace(
        frame,
        row_poses=RowPoses(
            times_ns=np.arange(48), world_from_camera=poses, ids=np.zeros(0, np.uint16),
            world_from_instance=np.zeros((48, 0, 4, 4)),
        ),
    )  # fmt: skip
    for name in POSED:
        with DatasetWriter(tmp_path / f"{name}_rolled", [name]) as writer:
            with pytest.raises(InvalidRequest, match="shutter"):
                writer.add(rolled)
            writer.add(frame)
    shifted = replace(frame.camera.intrinsics, cx_offset_px=2.0)
    other = replace(frame, camera=replace(frame.camera, intrinsics=shifted))
    with DatasetWriter(tmp_path / "3dgs", ["3dgs"]) as writer:
        with pytest.raises(InvalidRequest, match="axis"):
            writer.add(other)
        writer.add(frame)
    with DatasetWriter(tmp_path / "scannet", ["scannet"]) as writer:
        writer.add(frame)
        with pytest.raises(InvalidRequest, match="lens"):
            writer.add(other)


def test_all_formats_are_known() -> None:
    assert set(POSED) <= set(FORMATS)


def test_a_recipe_writes_a_model_for_each_clip_and_asks_with_facts(tmp_path: Path) -> None:
    """Points are there, those of both formats the same; questions know what touches."""
    recipe = written_recipe(
        tmp_path,
        clips={"train": 2},
        clip={"frames": 2, "rate": 10.0, "per_scene": 2},
        cameras=[SMALL["cameras"][0]],
        formats=["colmap", "3dgs", "vqa"],
    )
    job = load_job(recipe)
    assert job.recipe.needs_facts
    make_dataset(job, tmp_path / "made", engine_of(1, None))
    for clip in ("000000", "000001"):
        models = [tmp_path / "made" / name / "train" / clip / "sparse" / "0" / "points3D.txt"
                  for name in ("colmap", "3dgs")]  # fmt: skip
        assert models[0].read_bytes() == models[1].read_bytes() != b""
        assert not list(tmp_path.rglob(".seen"))
    lines = (tmp_path / "made" / "vqa" / "train.jsonl").read_text().splitlines()
    kinds = {json.loads(line)["kind"] for line in lines}
    assert "distance" in kinds


def test_splits_are_told_as_their_readers_look_for_them(taken: list[Frame], tmp_path: Path) -> None:
    """nerfstudio in its table, Gaussian splatting beside the model, the others as lists."""
    splits = Splits((0.5, 0.0, 0.5), seed=1)
    by_split: dict[str, list[int]] = {}
    with DatasetWriter(tmp_path, POSED, splits=splits) as writer:
        for number in range(4):
            by_split.setdefault(splits.of_frame(number), []).append(number)
            writer.add(taken[number % 2])
    assert {*by_split} == {"train", "test"}
    for name in ("nerfstudio", "instant-ngp"):
        table = json.loads((tmp_path / name / "transforms.json").read_text())
        assert "val_filenames" not in table
        for split, numbers in by_split.items():
            assert table[f"{split}_filenames"] == [f"images/{n:06d}.png" for n in numbers]
    lists = {
        "colmap/sparse/0": "{:06d}.png",
        "3dgs/sparse/0": "{:06d}.png",
        "scannet": "color/{}.jpg",
        "replica": "results/frame{:06d}.jpg",
        "hypersim": "images/scene_cam_00_final_preview/frame.{:04d}.tonemap.jpg",
    }
    for folder, form in lists.items():
        for split, numbers in by_split.items():
            lines = (tmp_path / folder / f"{split}.txt").read_text().splitlines()
            assert lines == [form.format(n) for n in numbers]
            if "/" in form:
                assert all((tmp_path / folder / line).is_file() for line in lines)
        assert not (tmp_path / folder / "val.txt").exists()


def test_bent_lenses_are_undistorted_on_request(tmp_path: Path) -> None:
    """Points lie where they are seen: on the box's faces and the ground."""
    scene = tmp_path / "box.yaml"
    scene.write_text(SCENE)
    lens = CameraIntrinsics(
        width=64, height=48, distortion_model="plumb_bob", distortion=(-0.2, 0.05, 0.0, 0.0)
    )
    spec = AgentSpec(name="eye", intrinsics=lens, views=VIEWS, following=False)
    with (
        Simulation(scene, mode="lockstep", agent=spec) as simulation,
        DatasetWriter(tmp_path / "straight", ["3dgs"], undistort=True) as writer,
    ):
        for eye in EYES:
            simulation.set_pose(look_at(eye, (2.5, 0.0, 0.4)))
            frame = simulation.capture()
            writer.add(frame)
        with pytest.raises(InvalidRequest, match="pinhole"):
            DatasetWriter(tmp_path / "bent", ["3dgs"]).add(frame)
    model = tmp_path / "straight" / "sparse" / "0"
    assert (model / "cameras.txt").read_text().split()[1] == "PINHOLE"
    lines = [line.split() for line in (model / "points3D.txt").read_text().splitlines()]
    points = np.array([[float(word) for word in line[1:4]] for line in lines])
    assert len(points) > 100
    from_box = np.abs(np.abs(points - (2.5, 0.3, 0.5)).max(axis=1) - 0.5)
    off = np.minimum(from_box, np.abs(points[:, 2]))
    # Pixels at edges of the box lie between two of its faces.
    assert np.percentile(off, 95.0) < 1e-3 < off.max() < 0.03
