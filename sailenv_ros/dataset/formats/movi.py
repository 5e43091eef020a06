"""Frames → NumPy archives with the arrays of Kubric's MOVi data sets, in metres and pixels.

`load_movi_frame` reads one back as a `Frame`, of which motion to any other one can be computed.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.data_files import write_bytes
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Sample, WriteResult
from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import motion, object_coordinates
from sailenv_ros.types.camera import INTRINSICS_LIMITS, Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.instance_states import InstanceStates

__all__ = ["MoviExport", "lens_arrays", "lens_of", "load_movi_frame"]

_NAMES = {
    "rgb": "video",
    "depth": "depth",
    "instance": "segmentations",
    "normals": "normal",
    "object_coords": "object_coordinates",
    "category": "category",
}
"""MOVi's names of the views."""


class MoviExport(DatasetFormat):
    """One ``.npz`` for each frame.

    ``video`` (H, W, 3) uint8; ``depth`` (H, W) float32 along the optical axis [m];
    ``segmentations`` (H, W) uint16, instance ids; ``object_coordinates`` (H, W, 3) float32 [m] in
    each instance's own frame; ``forward_flow`` and ``backward_flow`` (H, W, 2) float32 [px], rows
    first, to the next frame and, as Kubric has it, from the frame before; ``forward_occluded``,
    ``forward_out_of_view`` and the same of backward (H, W) bool; of the N instances ``ids``,
    ``positions`` (N, 3) [m], ``quaternions`` (N, 4) w first, ``velocities``,
    ``angular_velocities``, ``scales``, ``histories``; of the camera ``K``, ``world_from_camera``
    and its lens.
    """

    views: ClassVar[tuple[str, ...]] = ("depth", "instance")
    needs_neighbours: ClassVar[bool] = True

    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's file."""
        frame, states = sample.frame, sample.frame.states
        if states is None:
            raise RecordingError("MOVi needs the states of instances, which were not recorded")
        arrays: dict[str, Any] = {
            _NAMES[view]: values for view, values in frame.views.items() if view in _NAMES
        }
        arrays.setdefault("object_coordinates", object_coordinates(frame))
        fields = 0
        for name, other, sign in (
            ("forward", sample.following, 1.0),
            ("backward", sample.previous, -1.0),
        ):
            if other is not None and (other.scene, other.epoch) == (frame.scene, frame.epoch):
                moved = motion(frame, other)
                arrays[f"{name}_flow"] = np.float32(sign) * moved.flow[..., ::-1]
                arrays[f"{name}_occluded"] = moved.occluded
                arrays[f"{name}_out_of_view"] = moved.out_of_view
                fields += 1
        arrays |= _of_instances(states) | _of_camera(frame)
        data = io.BytesIO()
        np.savez_compressed(data, **arrays)
        write_bytes(self.folder / sample.split / f"{sample.stem}.npz", data.getvalue())
        return WriteResult(written={"frames": 1, "flow fields": fields})


def lens_arrays(lens: CameraIntrinsics) -> dict[str, Any]:
    """Return its numbers in the order of `INTRINSICS_LIMITS`, and its model if it has one."""
    if lens.is_pinhole and not lens.fx_px:
        return {"lens": np.array([*lens.numbers().values()], np.float64)}
    return {
        "lens": np.array([getattr(lens, name) for name in INTRINSICS_LIMITS], np.float64),
        "distortion_model": np.str_(lens.distortion_model),
        "distortion": lens.D,
    }


def lens_of(arrays: Mapping[str, NDArray[Any]]) -> CameraIntrinsics:
    """Return the lens that `lens_arrays` told of."""
    lens: dict[str, Any] = {
        name: int(number) if limits.whole else number
        for (name, limits), number in zip(
            INTRINSICS_LIMITS.items(), arrays["lens"].tolist(), strict=False
        )
    }
    if "distortion_model" in arrays:
        lens["distortion_model"] = str(arrays["distortion_model"])
        lens["distortion"] = tuple(arrays["distortion"].tolist())
    return CameraIntrinsics(**lens)


def load_movi_frame(path: str | Path) -> Frame:
    """Read a file of the format ``movi`` as a frame.

    Nothing of the file is run: it holds arrays of numbers and texts alone.

    Raises
    ------
    RecordingError
        If it cannot be read.
    """
    try:
        with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as stored:
            arrays = dict(stored)
        position, quat = arrays["camera_position"], arrays["camera_quaternion"]
        w, x, y, z = (float(value) for value in quat)
        return Frame(
            agent=str(arrays["agent"]),
            scene=str(arrays["scene"]),
            epoch=int(arrays["epoch"]),
            revision=0,
            sequence=int(arrays["sequence"]),
            stamp_ns=int(arrays["stamp_ns"]),
            dt_ns=int(arrays["dt_ns"]),
            camera=Camera(
                intrinsics=lens_of(arrays),
                pose=Pose(tuple(position.tolist()), (x, y, z, w)),
            ),
            views={view: arrays[name] for view, name in _NAMES.items() if name in arrays},
            states=_states_of(arrays),
        )
    except (OSError, KeyError, ValueError, TypeError, BadZipFile, InvalidRequest) as problem:
        raise RecordingError(f"{path} is no frame of the format movi: {problem}") from None


def _of_instances(states: InstanceStates) -> dict[str, NDArray[Any]]:
    return {
        "ids": states.ids,
        "positions": states.positions,
        "quaternions": states.orientations[:, [3, 0, 1, 2]],
        "velocities": states.linear_velocities,
        "angular_velocities": states.angular_velocities,
        "scales": states.scales,
        "histories": states.histories,
    }


def _states_of(arrays: dict[str, Any]) -> InstanceStates:
    return InstanceStates(
        ids=arrays["ids"],
        positions=arrays["positions"],
        orientations=arrays["quaternions"][:, [1, 2, 3, 0]],
        linear_velocities=arrays["velocities"],
        angular_velocities=arrays["angular_velocities"],
        scales=arrays["scales"],
        histories=arrays["histories"],
    )


def _of_camera(frame: Frame) -> dict[str, Any]:
    lens = frame.camera.intrinsics
    x, y, z, w = frame.camera.pose.orientation_xyzw
    return {
        "K": lens.K,
        "world_from_camera": frame.camera.world_from_camera,
        "camera_position": np.array(frame.camera.pose.position_m),
        "camera_quaternion": np.array([w, x, y, z]),
        **lens_arrays(lens),
        "stamp_ns": np.int64(frame.stamp_ns),
        "dt_ns": np.int64(frame.dt_ns),
        "epoch": np.int64(frame.epoch),
        "sequence": np.uint64(frame.sequence),
        "agent": np.str_(frame.agent),
        "scene": np.str_(frame.scene),
    }
