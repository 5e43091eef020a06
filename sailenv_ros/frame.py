"""A frame: the bundle of views that one camera sees at one instant, and what each view is.

Comes from `render/` by way of `simulation.py`, goes to messages, sockets, files and windows.
`VIEWS` is the one vocabulary of views: whoever needs a shape, a type, a unit or an encoding
reads it there.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera
from sailenv_ros.errors import InvalidRequest, UnknownName

__all__ = ["FIVE_VIEWS", "VIEWS", "Frame", "ViewSpec", "checked_views"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewSpec:
    """What one view is.

    Attributes
    ----------
    name : str
    dtype : numpy dtype
    channels : int
        1 means an array (H, W), otherwise (H, W, channels).
    encoding : str
        Encoding on a ROS topic (`sensor_msgs/image_encodings`).
    meaning : str
        One line: meaning, unit, special values.
    needs_past : bool
        True if the view refers to an earlier frame of the same camera.
    """

    name: str
    dtype: np.dtype[Any]
    channels: int
    encoding: str
    meaning: str
    needs_past: bool = False

    def shape(self, height: int, width: int) -> tuple[int, ...]:
        """Give the shape of this view's array for a picture of that size."""
        return (height, width) if self.channels == 1 else (height, width, self.channels)


def _spec(
    name: str, dtype: type, channels: int, encoding: str, meaning: str, *, past: bool = False
) -> ViewSpec:
    return ViewSpec(
        name=name,
        dtype=np.dtype(dtype),
        channels=channels,
        encoding=encoding,
        meaning=meaning,
        needs_past=past,
    )


VIEWS: Mapping[str, ViewSpec] = MappingProxyType(
    {
        spec.name: spec
        for spec in (
            _spec("rgb", np.uint8, 3, "rgb8", "the picture: red, green, blue (sRGB)"),
            _spec(
                "depth",
                np.float32,
                1,
                "32FC1",
                "depth along the optical axis [m]; +inf nothing hit, NaN nearer than near_m",
            ),
            _spec("category", np.uint8, 1, "8UC1", "category id; 0 background, 255 unlabelled"),
            _spec("instance", np.uint16, 1, "16UC1", "instance id; 0 background"),
            _spec(
                "flow",
                np.float32,
                2,
                "32FC2",
                "velocity in the image [px/s], u right, v down; NaN where flow_valid is False",
                past=True,
            ),
            _spec(
                "flow_valid",
                np.bool_,
                1,
                "8UC1",
                "True where the surface point had a place in the previous frame's image plane",
                past=True,
            ),
            _spec(
                "occlusion",
                np.bool_,
                1,
                "8UC1",
                "True where the surface point was not visible in the previous frame",
                past=True,
            ),
            _spec(
                "normals",
                np.float32,
                3,
                "32FC3",
                "unit surface normal in the optical frame; 0 nothing hit",
            ),
        )
    }
)
"""Every view by name."""

FIVE_VIEWS: tuple[str, ...] = ("rgb", "depth", "category", "instance", "flow")
"""What an agent gets unless it asks otherwise."""


def checked_views(names: Iterable[str]) -> tuple[str, ...]:
    """Check names of views: known, at least one, each once; in the order of `VIEWS`.

    Raises
    ------
    UnknownName
        If a name is not in `VIEWS`.
    InvalidRequest
        If there is none.
    """
    wanted = set(names)
    for name in sorted(wanted):
        if name not in VIEWS:
            raise UnknownName("view", name, VIEWS)
    if not wanted:
        raise InvalidRequest("views", (), f"at least one of: {', '.join(VIEWS)}")
    return tuple(name for name in VIEWS if name in wanted)


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """All views of one camera at one instant.

    Attributes
    ----------
    agent : str
        Whose camera.
    scene : str
    epoch, revision : int
        Of the scene's contents that were drawn (see `snapshot.SceneContents`).
    sequence : int
        Counts this agent's frames from 1.
    stamp_ns : int
        Simulated time [ns].
    dt_ns : int
        Simulated time since the frame that flow refers to [ns]; 0 if there is none.
    camera : Camera
    views : mapping of str to array
        Arrays as `VIEWS` says, read-only, never written again.
    timings_s : mapping of str to float
        Wall time of each stage of making it [s]; ``render`` is the whole.
    """

    agent: str
    scene: str
    epoch: int
    revision: int
    sequence: int
    stamp_ns: int
    dt_ns: int
    camera: Camera
    views: Mapping[str, NDArray[Any]]
    timings_s: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        height, width = self.camera.intrinsics.height, self.camera.intrinsics.width
        for name, array in self.views.items():
            spec = VIEWS[name]
            shape = spec.shape(height, width)
            if array.shape != shape or array.dtype != spec.dtype:
                raise ValueError(
                    f"view {name} must be {shape} {spec.dtype}, got {array.shape} {array.dtype}"
                )
            array.flags.writeable = False
        object.__setattr__(self, "views", MappingProxyType(dict(self.views)))

    def __getitem__(self, view: str) -> NDArray[Any]:
        if view not in self.views:
            raise UnknownName("view", view, self.views)
        return self.views[view]

    @property
    def dt_s(self) -> float:
        """Simulated time since the frame that flow refers to [s]; 0 if there is none."""
        return self.dt_ns * 1e-9
