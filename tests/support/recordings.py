"""Recordings for tests: frames of noise, written as the simulator's frames are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros.frame.frame import Frame
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.recording.topics import RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.labels import Category, CategoryTable, Instance
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import FIVE_VIEWS, VIEWS

SMALL = CameraIntrinsics(width=32, height=24, vertical_fov_deg=57.0)
DT_NS = 33_333_333


def noise_frame(
    sequence: int,
    *,
    agent: str = "eye",
    views: tuple[str, ...] = FIVE_VIEWS,
    intrinsics: CameraIntrinsics = SMALL,
    stamp_ns: int | None = None,
    epoch: int = 1,
) -> Frame:
    """Return a frame whose pixels follow from its number: all bit patterns in depth and flow."""
    noise = np.random.default_rng([sequence, len(agent)])
    arrays = {view: _noise(view, intrinsics, noise) for view in views}
    return Frame(
        agent=agent,
        scene="noise",
        epoch=epoch,
        revision=1,
        sequence=sequence,
        stamp_ns=(sequence - 1) * DT_NS if stamp_ns is None else stamp_ns,
        dt_ns=0 if sequence == 1 else DT_NS,
        camera=Camera(
            intrinsics=intrinsics,
            pose=Pose.from_rpy_deg((0.1 * sequence, 1.0, 2.0), (1.0, 2.0, 3.0 * sequence)),
        ),
        views=arrays,
        timings_s={"render": 0.25},
        info=noise_info(epoch=epoch),
        states=noise_states(sequence),
    )


def noise_states(sequence: int) -> InstanceStates:
    """Return where the two objects of `noise_info` are in the frame of that number."""
    poses = [Pose.from_rpy_deg((1.0, 2.0, k), (0.0, k * 9.0, 5.0)) for k in (0, sequence)]
    return InstanceStates(
        ids=np.array([1, 2], np.uint16),
        positions=np.array([pose.position_m for pose in poses]),
        orientations=np.array([pose.orientation_xyzw for pose in poses]),
        linear_velocities=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, sequence / 3.0]]),
        angular_velocities=np.array([[0.0, 0.0, 0.0], [0.1, 0.2, 0.3]]),
        scales=np.array([[1.0, 1.0, 1.0], [2.0, 1.0, 0.5]]),
        histories=np.array([1, 2]),
    )


def _noise(view: str, intrinsics: CameraIntrinsics, noise: np.random.Generator) -> Any:
    spec = VIEWS[view]
    shape = spec.shape(intrinsics.height, intrinsics.width)
    if spec.dtype == np.bool_:
        return noise.random(shape) < 0.5
    if view == "instance":
        return noise.integers(0, 3, shape).astype(np.uint16)
    if view == "category":
        return noise.choice(np.array([0, 3, 9], np.uint8), shape)
    if spec.dtype == np.uint8:
        return noise.integers(0, 256, shape).astype(np.uint8)
    if view == "raw":
        return noise.integers(0, 65536, shape).astype(np.uint16)
    values = noise.normal(3.0, 50.0, shape).astype(np.float32)
    values.reshape(-1)[:4] = [np.nan, np.nan if view == "flow" else np.inf, -0.0, 1e-42]
    return values


def noise_info(*agents: AgentSpec, epoch: int = 1, sim_time_ns: int = 0) -> SceneInfo:
    """Return what would be told of the scene of `noise_frame`."""
    return SceneInfo(
        scene="noise",
        scenes=("noise", "other"),
        epoch=epoch,
        revision=1,
        sim_time_ns=sim_time_ns,
        mode="lockstep",
        paused=False,
        real_time_factor=1.0,
        seed=0,
        categories=CategoryTable(
            [
                Category(id=3, name="chair", colour=(200, 10, 10)),
                Category(id=9, name="lamp", colour=(10, 200, 10)),
            ]
        ),
        instances=(
            Instance(
                id=1, name="chair_1", asset="chair", category_id=3, category="chair", static=True
            ),
            Instance(
                id=2, name="lamp_1", asset="lamp", category_id=9, category="lamp", static=False
            ),
        ),
        moving=frozenset({2}),
        spawnables=("chair",),
        agents=agents or (AgentSpec(name="eye", intrinsics=SMALL),),
    )


def write_noise(
    folder: Path, count: int, options: RecordingOptions | None = None, **fields: Any
) -> list[Frame]:
    """Record so many frames; return them."""
    frames = [noise_frame(number, **fields) for number in range(1, count + 1)]
    with RecordingWriter(folder, options) as writer:
        recorder = FrameRecorder(writer)
        recorder.write_info(noise_info())
        for frame in frames:
            recorder.write_frame(frame, 10.0)
    return frames


@contextmanager
def file_size_limit(limit: int) -> Iterator[None]:
    """Refuse, as a full disk does, whatever would make a file larger than this [B]."""
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
