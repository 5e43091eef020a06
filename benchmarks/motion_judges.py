"""Motion and tracks compared with programs of others, which are not part of this package.

    python benchmarks/motion_judges.py --rigid DIR --tapnet DIR --kubric DIR --python PYTHON

Each option is given for the judges that are there, checked out from GitHub: mmbannert/
rigid-v-nonrigid-flow, google-deepmind/tapnet, google-research/kubric. PYTHON is an interpreter with
tensorflow-cpu, for Kubric alone. Prints what `docs/experiments.md` tells.
"""

from __future__ import annotations

import argparse
import ast
import itertools
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.flow_accuracy import EYE, STEPS, begin_scenario, flow_test_scene
from sailenv_bench.experiments.flow_scenes import SCENARIOS
from sailenv_ros import Simulation
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import SceneGeometry, motion, track
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at

LENGTH = 24


def judge_rigid(folder: Path) -> None:
    """Compare the flow of a still room with theirs from depth, pose and K."""
    spec = AgentSpec(
        name="eye", intrinsics=CameraIntrinsics(), following=False, rate_hz=0.0, views=("depth",)
    )
    frames = []
    with Simulation("room_02", mode="lockstep", agent=spec) as simulation:
        for place in ((1.2, 0.0, 1.5), (1.0, 0.4, 1.45)):
            simulation.step(240)
            simulation.set_pose(look_at(place, (0.0, 0.0, 0.6)), agent="eye")
            frames.append(simulation.capture(("depth", "instance"), agent="eye"))
    one, other = frames
    moved = motion(one, other)
    rest = _beyond_rigid(folder, one, other, np.eye(4), np.eye(4))
    still = moved.valid & (moved.scene_flow == 0.0).all(axis=-1)
    error = np.linalg.norm(rest[still], axis=-1)
    length = np.linalg.norm(moved.flow[still], axis=-1)
    print(
        f"rigid-v-nonrigid-flow: {still.mean():.1%} of 640 x 480 px, motion {length.mean():.1f} px "
        f"on average, difference {error.mean():.1e} px, at most {error.max():.1e} px"
    )


def judge_links(folder: Path) -> None:
    """Compare the flow of each link of a moving arm with theirs: a link is still in its frame."""
    spec = AgentSpec(
        name="eye", intrinsics=CameraIntrinsics(), following=False, rate_hz=0.0, views=("depth",)
    )
    frames = []
    with Simulation("optical", mode="lockstep", agent=spec) as simulation:
        simulation.spawn_robot("pybullet_data:franka_panda/panda.urdf", (0.0, -1.5, 0.0))
        joints = {f"panda_joint{number}": -0.8 for number in (1, 2, 3, 4)}
        simulation.drive_joints(joints | {"panda_joint6": 1.0, "panda_finger_joint1": 0.04})
        for x in (1.6, 1.55):
            simulation.step(60)
            simulation.set_pose(look_at((x, -0.6, 0.9), (0.0, -1.5, 0.5)), agent="eye")
            frames.append(simulation.capture(("depth", "instance"), agent="eye"))
        links = [i for i in simulation.info.instances if i.category == "robot"]
    one, other = frames
    moved = motion(one, other)
    errors, lengths = [], []
    for link in links:
        states = [frame.states for frame in frames if frame.states is not None]
        poses = [one.matrices[one.row(link.id)] for one in states]
        rest = _beyond_rigid(folder, one, other, *poses)
        seen = moved.valid & (one["instance"] == link.id)
        if seen.any():
            errors.append(np.linalg.norm(rest[seen], axis=-1).max())
            lengths.append(np.linalg.norm(moved.flow[seen], axis=-1).mean())
    print(
        f"rigid-v-nonrigid-flow: {len(errors)} of {len(links)} links seen, motion of a link "
        f"{min(lengths):.1f} to {max(lengths):.1f} px, difference at most {max(errors):.1e} px"
    )


def _beyond_rigid(
    folder: Path,
    one: Frame,
    other: Frame,
    world_from_thing: NDArray[np.float64],
    world_from_moved: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return (H, W, 2): what their program leaves of the flow [px] of a thing that was moved."""
    sys.path.insert(0, str(folder))
    from tools.flowcalc import calc_rigid_and_nonrigid_flow  # type: ignore[import-not-found]

    places = ((one, world_from_thing), (other, world_from_moved))
    cameras = [
        (frame.camera.intrinsics.K, (frame.camera.camera_from_world @ place)[:3])
        for frame, place in places
    ]
    depths = [frame["depth"].astype(np.float64) for frame in (one, other)]
    flow = np.nan_to_num(motion(one, other).flow.astype(np.float64))
    _, rest = calc_rigid_and_nonrigid_flow(tuple(depths), tuple(cameras), flow, flow.shape[:2])
    return np.asarray(rest)


def sequence(width: int, height: int) -> tuple[list[Frame], SceneGeometry, list[Any]]:
    """Return frames of the scenario of moving camera and cube, its geometry and its boxes."""
    views = ("rgb", "depth", "instance", "object_coords", "normals")
    with flow_test_scene(width, height) as simulation:
        boxes = begin_scenario(simulation, SCENARIOS["both"])
        frames = []
        for _ in range(LENGTH):
            simulation.step(2 * STEPS)
            frames.append(simulation.capture(views, agent=EYE))
        return frames, SceneGeometry.of_contents(simulation.contents), boxes


def judge_tapnet(folder: Path) -> None:
    """Score our tracks and those of OpenCV's Lucas-Kanade by the benchmark's metrics."""
    source = (folder / "tapnet/tapvid/evaluation_datasets.py").read_text()
    functions: list[ast.stmt] = [
        node
        for node in ast.parse(source).body
        if isinstance(node, ast.FunctionDef) and node.name == "compute_tapvid_metrics"
    ]
    names: dict[str, Any] = {"np": np, "Mapping": dict}
    exec(compile(ast.Module(functions, []), "tapnet", "exec"), names)
    frames, geometry, _ = sequence(256, 256)
    grid = np.stack(np.meshgrid(np.arange(4, 256, 12), np.arange(4, 256, 12)), -1).reshape(-1, 2)
    queries = np.concatenate([np.zeros((len(grid), 1)), grid], axis=1)
    tracks = track(queries, frames, geometry)
    points, hidden = tracks.pixels + 0.5, tracks.occluded
    asked = np.stack([queries[:, 0], queries[:, 2] + 0.5, queries[:, 1] + 0.5], axis=-1)
    followed, lost = lucas_kanade([frame["rgb"] for frame in frames], grid)
    for name, (tracked, occluded) in {
        "our tracks against themselves": (points, hidden),
        "OpenCV's Lucas-Kanade": (followed + 0.5, lost),
    }.items():
        scores = names["compute_tapvid_metrics"](
            asked[None], hidden[None], points[None], occluded[None], tracked[None], "first"
        )
        shown = ", ".join(
            f"{key} {float(scores[key][0]):.3f}"
            for key in ("average_jaccard", "average_pts_within_thresh", "occlusion_accuracy")
        )
        print(f"tapnet's metrics, {len(grid)} points x {LENGTH} frames, {name}: {shown}")


def lucas_kanade(
    pictures: list[NDArray[np.uint8]], points: NDArray[Any]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Follow points by OpenCV's pyramidal Lucas-Kanade, from picture to picture."""
    greys = [cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY) for picture in pictures]
    places = [points.astype(np.float32)]
    lost = [np.zeros(len(points), np.bool_)]
    for before, after in itertools.pairwise(greys):
        found, status, _ = cv2.calcOpticalFlowPyrLK(before, after, places[-1][:, None], None)
        places.append(found[:, 0])
        lost.append(lost[-1] | (status[:, 0] == 0))
    return np.stack(places, axis=1).astype(np.float64), np.stack(lost, axis=1)


def judge_kubric(folder: Path, python: Path) -> None:
    """Run Kubric's point tracker on our arrays as Kubric has them, and compare."""
    size = 256
    frames, geometry, boxes = sequence(size, size)
    with tempfile.TemporaryDirectory() as temporary:
        given, taken = Path(temporary) / "given.npz", Path(temporary) / "taken.npz"
        arrays: Any = kubric_arrays(frames, boxes)
        np.savez(given, **arrays)
        program = Path(__file__).with_name("kubric_judge.py")
        path = folder / "challenges/point_tracking/dataset.py"
        subprocess.run([python, program, path, given, taken], check=True)
        with np.load(taken) as answer:
            queries, places, hidden = (answer[name] for name in ("queries", "places", "hidden"))
    # Theirs are time, row, column from the picture's corner.
    points = np.stack([queries[:, 0], queries[:, 2] - 0.5, queries[:, 1] - 0.5], axis=-1)
    tracks = track(points, frames, geometry)
    known = tracks.in_view
    error = np.linalg.norm(tracks.pixels + 0.5 - places, axis=-1)[known]
    same = (tracks.occluded == hidden)[known]
    wrong_visible = (tracks.occluded & ~hidden)[known].mean()
    print(
        f"Kubric's tracker, {len(points)} points x {LENGTH} frames of {size} px: places differ by "
        f"{np.median(error):.4f} px (median), {np.quantile(error, 0.99):.3f} px (99 %), "
        f"{error.max():.3f} px at most; visibility agrees at {same.mean():.2%}; visible for Kubric "
        f"and hidden for a ray {wrong_visible:.2%}, the other way "
        f"{(~same).mean() - wrong_visible:.2%}"
    )


def kubric_arrays(frames: list[Frame], boxes: list[Any]) -> dict[str, NDArray[Any]]:
    """Return what Kubric's data sets hold of such frames."""
    segments = {box.instance_id: number + 1 for number, box in enumerate(boxes)}
    table = np.zeros(65536, np.uint8)
    table[list(segments)] = list(segments.values())
    low = np.zeros((len(boxes) + 1, 3))
    size = np.ones((len(boxes) + 1, 3))
    for number, box in enumerate(boxes):
        low[number + 1], size[number + 1] = box.low, np.array(box.high) - box.low
    coords, segmentations, distances, normals, corners, quats = [], [], [], [], [], []
    positions, turns = [], []
    shares = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    for frame in frames:
        states = frame.states
        assert states is not None
        segment = table[frame["instance"]]
        share = (np.nan_to_num(frame["object_coords"]) - low[segment]) / size[segment]
        coords.append(np.rint(np.clip(share, 0, 1) * 65535).astype(np.uint16))
        segmentations.append(segment[..., None])
        lens = frame.camera.intrinsics
        rays = np.linalg.norm(lens.rays(), axis=-1)
        distances.append(frame["depth"] * rays)
        world = frame["normals"] @ frame.camera.world_from_camera[:3, :3].T
        normals.append(np.rint((world + 1) / 2 * 65535).astype(np.uint16))
        matrices = [states.matrices[states.row(box.instance_id)] for box in boxes]
        corners.append(
            [
                (low[n + 1] + shares * size[n + 1]) @ matrix[:3, :3].T + matrix[:3, 3]
                for n, matrix in enumerate(matrices)
            ]
        )
        quats.append(
            [states.orientations[states.row(box.instance_id)][[3, 0, 1, 2]] for box in boxes]
        )
        # Blender's cameras look along -z, with y up: half a turn about x from the optical frame.
        positions.append(frame.camera.world_from_camera[:3, 3])
        turns.append(_quat(frame.camera.world_from_camera[:3, :3] @ np.diag([1.0, -1.0, -1.0])))
    depth = np.array(distances)
    bounds = np.array([depth.min(), depth.max()], np.float32)
    return {
        "object_coordinates": np.array(coords),
        "segmentations": np.array(segmentations),
        "depth": np.rint((depth - bounds[0]) / np.ptp(bounds) * 65535).astype(np.uint16)[..., None],
        "depth_range": bounds,
        "normal": np.array(normals),
        "bboxes_3d": np.array(corners).transpose(1, 0, 2, 3).astype(np.float32),
        "quaternions": np.array(quats).transpose(1, 0, 2).astype(np.float32),
        "focal_length": np.float32(32.0 * lens.fx / lens.width),
        "sensor_width": np.float32(32.0),
        "camera_positions": np.array(positions, np.float32),
        "camera_quaternions": np.array(turns, np.float32),
    }


def _quat(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a quaternion w, x, y, z."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotation).as_quat()[[3, 0, 1, 2]])


def main() -> None:
    """Ask those judges that are there."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rigid", type=Path, help="checkout of rigid-v-nonrigid-flow")
    parser.add_argument("--tapnet", type=Path, help="checkout of tapnet")
    parser.add_argument("--kubric", type=Path, help="checkout of kubric")
    parser.add_argument("--python", type=Path, help="interpreter with tensorflow-cpu")
    args = parser.parse_args()
    if args.rigid:
        judge_rigid(args.rigid)
        judge_links(args.rigid)
    if args.tapnet:
        judge_tapnet(args.tapnet)
    if args.kubric and args.python:
        judge_kubric(args.kubric, args.python)


if __name__ == "__main__":
    main()
