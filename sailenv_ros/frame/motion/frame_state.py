"""State of a frame that motion needs, of a `FrameData` or of the dict of an agent."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.data import FrameData
from sailenv_ros.frame.lens_rays import depth_shares, ranges_of_depths, tells_depth
from sailenv_ros.frame.motion.rigid_motion import DeformedInstance, ObservedPoses
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.instance_states import InstanceStates

__all__ = ["AnyFrame", "FrameState", "frame_state_of", "require_common_past"]

AnyFrame: TypeAlias = FrameData | Mapping[str, Any]
"""A `FrameData`, or a frame as `Agent.get_frame` gives it."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class FrameState:
    """A camera and all instances at one instant.

    Attributes
    ----------
    scene : str
    epoch : int
        Of the scene: two epochs have no common past.
    stamp_ns : int
        Simulated time [ns].
    camera : Camera
    states : InstanceStates
    depth, instance : (H, W) float32, uint16 or None
        The frame's views; None if it has none.
    """

    scene: str
    epoch: int
    stamp_ns: int
    camera: Camera
    states: InstanceStates
    depth: NDArray[np.float32] | None
    instance: NDArray[np.uint16] | None
    range: NDArray[np.float32] | None = None

    def observed_poses(self) -> ObservedPoses:
        """Return camera and poses as tables of motion are made of."""
        states = self.states
        return ObservedPoses(
            camera=self.camera,
            ids=states.ids,
            world_from_instance=states.matrices,
            histories=states.histories,
            surfaces={
                key: DeformedInstance(shape, _scale_of(states, key))
                for key, shape in states.deformations.items()
            },
        )

    def surfaces(self, what: str) -> tuple[NDArray[np.float32], NDArray[np.uint16]]:
        """Return depth and instance ids; through a lens that bends straight lines range and ids.

        Parameters
        ----------
        what : str
            Which frame it is, for the error.

        Raises
        ------
        InvalidRequest
            If the frame has not both, or its lens sees to the side and it has no ``range``.
        """
        if self.depth is None or self.instance is None:
            missing = "without " + " and ".join(
                name
                for name, view in (("depth", self.depth), ("instance", self.instance))
                if view is None
            )
            raise InvalidRequest(what, missing, "a frame with the views depth and instance")
        lens, reach = self.camera.intrinsics, self.depth
        if not tells_depth(lens):
            reach = ranges_of_depths(self.depth, lens) if self.range is None else self.range
            if self.range is None and (depth_shares(lens) <= 0.0).any():
                accepted = "a frame with the view range, since its lens sees to the side"
                raise InvalidRequest(what, "without range", accepted)
        return np.ascontiguousarray(reach), np.ascontiguousarray(self.instance)


def frame_state_of(frame: AnyFrame, what: str = "frame") -> FrameState:
    """Read what motion needs of a frame.

    Parameters
    ----------
    frame : FrameData or mapping
    what : str
        Which frame it is, for errors.

    Raises
    ------
    InvalidRequest
        If it is no frame, or the states of its instances were not recorded.
    """
    if isinstance(frame, FrameData):
        fields: Mapping[str, Any] = {
            "scene": frame.scene,
            "epoch": frame.epoch,
            "stamp_ns": frame.stamp_ns,
            "camera": frame.camera,
            "states": frame.states,
            "depth": frame.views.get("depth"),
            "instance": frame.views.get("instance"),
            "range": frame.views.get("range"),
        }
    elif isinstance(frame, Mapping) and {"camera", "states", "epoch"} <= frame.keys():
        names = ("scene", "epoch", "stamp_ns", "camera", "states")
        fields = {name: frame[name] for name in names}
        views = {"depth": "depth_m", "instance": "instance", "range": "range"}
        fields |= {name: frame.get(key) for name, key in views.items()}
    else:
        raise InvalidRequest(what, type(frame).__name__, "a FrameData, or a frame of an Agent")
    if fields["camera"].picture.rolls:
        accepted = "a frame of a global shutter (row_time_us 0); the view flow knows rolling ones"
        raise InvalidRequest(what, "of a rolling shutter", accepted)
    if fields["states"] is None:
        accepted = "a frame with the states of its instances, which version 0.2.0 did not record"
        raise InvalidRequest(what, "without states", accepted)
    return FrameState(**fields)


def _scale_of(states: InstanceStates, instance_id: int) -> tuple[float, float, float]:
    x, y, z = states.scales[states.row(instance_id)].tolist()
    return x, y, z


def require_common_past(one: FrameState, other: FrameState) -> None:
    """Refuse moments of different scenes, or of different lives of one scene.

    Raises
    ------
    InvalidRequest
    """
    if (one.scene, one.epoch) != (other.scene, other.epoch):
        raise InvalidRequest(
            "frames",
            f"of {one.scene!r}, epoch {one.epoch}, and {other.scene!r}, epoch {other.epoch}",
            "frames of one epoch of a scene: a change of scene and a reset begin a new one",
        )
