"""COLMAP and nerfstudio, read back by plain parsers: lenses, poses and points against OpenCV."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from sailenv_ros.dataset.formats import DatasetWriter
from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.scene.calibration_files import colmap_camera, load_calibration
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at

SCENE = """
version: 1
objects:
  - {name: ground, asset: plane, static: true, category: floor}
  - {name: near, asset: cube, position: [2.5, 0.3, 0.5], rotation: [0, 0, 30], static: true}
  - {name: far, asset: cube, position: [5, -0.2, 0.5], scale: 1.5, static: true}
  - {name: ball, asset: sphere, position: [2.4, -1.0, 3]}
"""
VIEWS = ("rgb", "depth", "instance", "range")
LENSES: dict[str, dict[str, Any]] = {
    "pinhole": {},
    "plumb_bob": {
        "distortion_model": "plumb_bob",
        "distortion": (-0.2, 0.05, 0.001, -0.0005, 0.01),
        "fx_px": 100.0,
        "fy_px": 98.0,
        "cx_offset_px": 1.5,
    },
    "equidistant": {
        "distortion_model": "equidistant",
        "distortion": (0.02, -0.004, 0.001, 0.0),
        "fx_px": 60.0,
        "fy_px": 61.0,
        "max_angle_deg": 75.0,
    },
}
EYES = ((0.0, 0.0, 1.0), (0.2, 1.0, 1.4), (0.5, -1.5, 1.2), (1.0, 2.0, 2.0))


@pytest.fixture(scope="module", params=LENSES)
def taken(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    """Frames from four places, while a ball falls."""
    scene = tmp_path_factory.mktemp("solids") / "solids.yaml"
    scene.write_text(SCENE)
    lens = CameraIntrinsics(width=120, height=90, **LENSES[request.param])
    spec = AgentSpec(name="eye", intrinsics=lens, views=VIEWS, following=False)
    frames = []
    with Simulation(scene, mode="lockstep", agent=spec) as simulation:
        for eye in EYES:
            simulation.set_pose(look_at(eye, (3.0, 0.0, 0.5)))
            simulation.step(24)
            frames.append(simulation.capture())
    return frames


def written(folder: Path, frames: list[Frame], *formats: str) -> Path:
    """Write formats; of one alone its files lie in the folder itself."""
    with DatasetWriter(folder, list(formats)) as writer:
        for frame in frames:
            writer.add(frame)
        writer.finish()
    return folder


def projected(model: str, numbers: list[float], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the pixels of (N, 3) optical points by OpenCV; (0, 0) is the picture's corner."""
    fx, fy, cx, cy, *law = numbers
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    still, own = np.zeros(3), points.reshape(-1, 1, 3)
    if model == "OPENCV_FISHEYE":
        found, _ = cv2.fisheye.projectPoints(own, still, still, matrix, np.array(law))
    else:
        found, _ = cv2.projectPoints(own, still, still, matrix, np.array(law or [0.0] * 4))
    return np.asarray(found).reshape(-1, 2)


def test_colmap_files_hold_exact_lenses_poses_and_tracks(
    taken: list[Frame], tmp_path: Path
) -> None:
    """Each observation is where OpenCV projects the point to, on a surface that the frame shows."""
    folder = written(tmp_path, taken, "colmap")
    model = folder / "sparse" / "0"
    lens = taken[0].camera.intrinsics
    again = load_calibration(model / "cameras.txt")
    np.testing.assert_array_equal(again.K, lens.K)
    (line,) = (model / "cameras.txt").read_text().splitlines()
    _, name, width, height, *numbers = line.split()
    assert (int(width), int(height)) == (120, 90)
    law = [float(number) for number in numbers]

    points = {}
    for line in (model / "points3D.txt").read_text().splitlines():
        number, x, y, z, *_, error = (words := line.split())[:8]
        points[int(number)] = (float(x), float(y), float(z)), [int(word) for word in words[8:]]
        assert error == "0"
    assert len(points) > 1000

    lines = (model / "images.txt").read_text().splitlines()
    seen: Counter[int] = Counter()
    for number, (pose, observed) in enumerate(zip(lines[::2], lines[1::2], strict=True)):
        frame = taken[number]
        first, *parts, camera, file = pose.split()
        assert (first, camera) == (str(number + 1), "1")
        picture = cv2.imread(str(folder / "images" / file))
        assert picture is not None
        np.testing.assert_array_equal(picture[..., ::-1], frame["rgb"])
        w, x, y, z, *shift = map(float, parts)
        turn, _ = cv2.Rodrigues(_vector((w, x, y, z)))
        np.testing.assert_allclose(
            turn, np.linalg.inv(frame.camera.world_from_camera)[:3, :3], atol=1e-12
        )
        numbers_of = np.array(observed.split(), np.float64).reshape(-1, 3)
        ids = numbers_of[:, 2].astype(int)
        seen.update(ids.tolist())
        for place, id_ in enumerate(ids.tolist()):
            track = points[id_][1]
            assert (number + 1, place) in zip(track[::2], track[1::2], strict=True)
        local = np.array([points[id_][0] for id_ in ids]) @ turn.T + shift
        np.testing.assert_allclose(projected(name, law, local), numbers_of[:, :2], atol=2e-6)
        column, row = np.rint(numbers_of[:, :2] - 0.5).astype(int).T
        off = np.abs(frame["range"][row, column] - np.linalg.norm(local, axis=1))
        assert (off <= 0.02 * frame["range"][row, column] + 0.01).all()
        assert (off < 1e-3).mean() > 0.1  # those of its own pixels, and more
    assert set(seen) == set(points)
    assert min(seen.values()) == 2
    assert max(seen.values()) == 4
    xyz = np.array([place for place, _ in points.values()])
    for frame in taken:  # the ball fell: no point lies on it
        assert frame.states is not None
        ball = next(id_ for id_, one in frame.instances.items() if one.name == "ball")
        centre = frame.states.positions[frame.states.row(ball)]
        radius = np.linalg.norm(xyz - centre, axis=1)
        assert (np.abs(radius - 0.5) > 1e-3).all()


def _vector(quat_wxyz: tuple[float, float, float, float]) -> NDArray[np.float64]:
    """Return the vector of rotation of a unit quaternion."""
    w, xyz = quat_wxyz[0], np.array(quat_wxyz[1:])
    length = float(np.linalg.norm(xyz))
    angle = 2.0 * np.arctan2(length, w)
    return np.asarray(xyz * (angle / length if length else 0.0))


def test_nerfstudio_s_table_has_the_same(taken: list[Frame], tmp_path: Path) -> None:
    """Poses in OpenGL's axes, lenses by its names, depth in millimetres, COLMAP's points."""
    folder = written(tmp_path, taken, "nerfstudio", "colmap")
    table = json.loads((folder / "nerfstudio" / "transforms.json").read_text())
    lens = taken[0].camera.intrinsics
    fisheye = lens.distortion_model == "equidistant"
    assert table["camera_model"] == ("OPENCV_FISHEYE" if fisheye else "OPENCV")
    assert table.get("is_fisheye", False) == fisheye
    names = ("k1", "k2", "k3", "k4") if fisheye else ("k1", "k2", "p1", "p2", "k3")
    assert tuple(table[name] for name in names if name in table) == lens.distortion
    assert (table["fl_x"], table["fl_y"], table["w"], table["h"]) == (lens.fx, lens.fy, 120, 90)
    assert (table["cx"], table["cy"]) == (lens.cx + 0.5, lens.cy + 0.5)
    for frame, entry in zip(taken, table["frames"], strict=True):
        matrix = np.array(entry["transform_matrix"])
        pose = frame.camera.world_from_camera
        np.testing.assert_array_equal(matrix[:, 0], pose[:, 0])
        np.testing.assert_array_equal(matrix[:3, 1:3], -pose[:3, 1:3])
        np.testing.assert_array_equal(matrix[:, 3], pose[:, 3])
        depth = cv2.imread(str(folder / "nerfstudio" / entry["depth_file_path"]), -1)
        assert depth is not None
        known = np.isfinite(frame["depth"]) & (frame["depth"] > 0.0)
        assert (depth[~known] == 0).all()
        assert np.abs(depth[known] - 1000.0 * frame["depth"][known]).max() <= 0.501
        assert (folder / "nerfstudio" / entry["file_path"]).exists()
    cloud = trimesh.load(folder / "nerfstudio" / table["ply_file_path"])
    text = (folder / "colmap" / "sparse" / "0" / "points3D.txt").read_text().splitlines()
    told = np.array([line.split()[1:7] for line in text], np.float64)
    np.testing.assert_allclose(cloud.vertices, told[:, :3], atol=1e-6)
    np.testing.assert_array_equal(cloud.colors[:, :3], told[:, 3:])
    assert not list(folder.rglob(".seen"))


def test_frames_of_two_epochs_make_two_models(tmp_path: Path) -> None:
    """The second lies in a folder of its own; what was kept for the points is gone."""
    (tmp_path / "solids.yaml").write_text(SCENE)
    lens = CameraIntrinsics(width=64, height=48)
    spec = AgentSpec(name="eye", intrinsics=lens, views=VIEWS, following=False)
    frames = []
    with Simulation(tmp_path / "solids.yaml", mode="lockstep", agent=spec) as simulation:
        for _ in range(2):
            simulation.set_pose(look_at((0.0, 0.0, 1.0), (3.0, 0.0, 0.5)))
            for _ in range(2):
                simulation.step(8)
                frames.append(simulation.capture())
            simulation.reset()
    out = written(tmp_path / "out", frames, "colmap")
    models = sorted(str(path.parent.relative_to(out)) for path in out.rglob("images.txt"))
    assert models == [f"solids_{frames[2].epoch}/sparse/0", "sparse/0"]
    assert len(list(out.rglob("*.png"))) == 4
    assert not list(out.rglob(".seen"))


@pytest.mark.parametrize("name", ["colmap", "nerfstudio"])
def test_what_a_format_has_no_model_of_is_refused(tmp_path: Path, name: str) -> None:
    """The lens is named, with those that are accepted; so is what was not recorded."""
    lens = CameraIntrinsics(
        width=64,
        height=48,
        fx_px=30.0,
        fy_px=30.0,
        distortion_model="double_sphere",
        distortion=(-0.2, 0.6),
    )
    spec = AgentSpec(name="eye", intrinsics=lens, views=VIEWS)
    (tmp_path / "solids.yaml").write_text(SCENE)
    with Simulation(tmp_path / "solids.yaml", mode="lockstep", agent=spec) as simulation:
        frame = simulation.capture()
    with DatasetWriter(tmp_path / "out", [name]) as writer:
        with pytest.raises(
            InvalidRequest, match=r"distortion_model must be .*, got 'double_sphere'"
        ):
            writer.add(frame)
        pinhole = replace(frame.camera, intrinsics=CameraIntrinsics(width=64, height=48))
        with pytest.raises(RecordingError, match="needs the states of instances"):
            writer.add(replace(frame, camera=pinhole, states=None))


def test_each_lens_has_colmap_s_shortest_model() -> None:
    """Read back, it is the same lens."""
    made = {"width": 640, "height": 480, "fx_px": 500.0, "fy_px": 501.0}
    rational = (0.1, 0.02, 1e-3, -1e-3, 0.01, 0.2, 0.03, 0.001)
    for model, law, name in (
        ("pinhole", (), "PINHOLE"),
        ("plumb_bob", (-0.2, 0.05, 0.001, 0.002), "OPENCV"),
        ("plumb_bob", (-0.2, 0.05, 0.001, 0.002, 0.0), "OPENCV"),
        ("plumb_bob", (-0.2, 0.05, 0.001, 0.002, 0.01), "FULL_OPENCV"),
        ("rational_polynomial", rational, "FULL_OPENCV"),
        ("equidistant", (0.01, 0.0, 0.0, 0.0), "OPENCV_FISHEYE"),
    ):
        lens = CameraIntrinsics(**made, distortion_model=model, distortion=law)
        found, (fx, fy, cx, cy, *rest) = colmap_camera(lens)
        assert (found, fx, fy, cx, cy) == (name, 500.0, 501.0, 320.0, 240.0)
        assert rest[: len(law)] == list(law[: len(rest)])
    prism = CameraIntrinsics(
        **made, distortion_model="rational_polynomial", distortion=(*rational, 1e-3, 0.0, 0.0, 0.0)
    )
    with pytest.raises(InvalidRequest, match="without thin prism"):
        colmap_camera(prism)
