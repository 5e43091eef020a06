"""A frame: the bundle of views that one camera sees at one instant, and what each view is.

Comes from `render/` by way of `simulation.py`, goes to messages, sockets, files and windows.
`VIEWS` says once what a view is: whoever makes, shows, sends, stores or documents views reads it
there and names none of its own.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera
from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.instance_states import InstanceStates

if TYPE_CHECKING:
    from sailenv_ros.object_truth import AmodalMasks, Keypoints, ObjectTable, PointCloud
    from sailenv_ros.scene_info import SceneInfo, SceneObject  # which knows what agents see

__all__ = [
    "ALWAYS_MADE",
    "FIVE_VIEWS",
    "VIEWS",
    "DrawAlone",
    "Frame",
    "RENDERED_VIEWS",
    "ImageCodec",
    "ViewDisplay",
    "ViewSource",
    "ViewSpec",
    "checked_views",
    "view_spec",
    "views_of",
]


ViewSource: TypeAlias = Literal["lighting", "annotation", "geometry", "motion"]
"""What makes a view: the lit picture; arithmetic on depth and instance id, which all back ends
share; an attribute of the surface, which the geometry pass writes as it is; or arithmetic on a
frame and the one that follows it, which no renderer makes (`sailenv_ros.motion`)."""

ViewDisplay: TypeAlias = Literal[
    "colour", "depth", "category", "instance", "flow", "direction", "mask", "place", "displacement"
]
"""How a view is shown as a picture; `pictures.colours` has a function for each."""

ImageCodec: TypeAlias = Literal["jpeg", "png"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewSpec:
    """What one view is, how it is made, shown and sent.

    Attributes
    ----------
    name : str
    dtype : numpy dtype
    channels : int
        1 means an array (H, W), otherwise (H, W, channels).
    encoding : str
        Encoding on a ROS topic (`sensor_msgs/image_encodings`).
    meaning : str
        One line: what a value is, in which unit and frame.
    unit : str
        Of the values, as it is shown to people; empty for none.
    invalid : str
        Values that stand for something else than a measurement; empty if there are none.
    source : {'lighting', 'annotation', 'geometry', 'motion'}
        What makes it. A view of 'geometry' is an output of the geometry pass of the same name.
    needs_past : bool
        True if the view refers to an earlier frame of the same camera.
    needs_past_depth : bool
        True if the depth of that earlier frame is needed too.
    needs_next : bool
        True if the view refers to the next frame of the same camera: it is known one frame late.
    by_default : bool
        True if an agent gets it without asking.
    wide_dtype : numpy dtype or None
        Type of its values where they are too large for `dtype`; None if they never are.
    wide_encoding : str
        Encoding on a ROS topic of these.
    display : str
        How it is shown as a picture.
    color_topic : bool
        True if it has a topic `<view>/color` with that picture.
    compressed_topic : {'jpeg', 'png'} or None
        Codec of the topic `<view>/compressed`; None if there is no such topic. A picture may lose
        something, labels may not.
    png_per_unit : float or None
        Steps per unit of its 16-bit PNG files; None if files hold the values themselves, or the
        picture of values that are no integers.
    validity_of : str
        The view whose values it says to exist; empty for others.
    """

    name: str
    dtype: np.dtype[Any]
    channels: int = 1
    encoding: str
    meaning: str
    display: ViewDisplay
    source: ViewSource
    unit: str = ""
    invalid: str = ""
    needs_past: bool = False
    needs_past_depth: bool = False
    needs_next: bool = False
    by_default: bool = False
    color_topic: bool = False
    compressed_topic: ImageCodec | None = None
    png_per_unit: float | None = None
    validity_of: str = ""
    wide_dtype: np.dtype[Any] | None = None
    wide_encoding: str = ""

    @property
    def dtypes(self) -> tuple[np.dtype[Any], ...]:
        """Types that its array may have."""
        return (self.dtype,) if self.wide_dtype is None else (self.dtype, self.wide_dtype)

    def encoding_of(self, dtype: np.dtype[Any]) -> str:
        """Return the encoding on a ROS topic of an array of one of `dtypes`."""
        return self.wide_encoding if dtype == self.wide_dtype else self.encoding

    @property
    def is_label(self) -> bool:
        """True if values are ids or truth values: between two of them there is nothing."""
        return self.display in ("category", "instance", "mask")

    def shape(self, height: int, width: int) -> tuple[int, ...]:
        """Return the shape of this view's array for a picture of that size."""
        return (height, width) if self.channels == 1 else (height, width, self.channels)


_SPECS = (
    ViewSpec(
        name="rgb",
        dtype=np.dtype(np.uint8),
        channels=3,
        encoding="rgb8",
        meaning="the picture: red, green, blue (sRGB)",
        display="colour",
        source="lighting",
        by_default=True,
        compressed_topic="jpeg",
    ),
    ViewSpec(
        name="depth",
        dtype=np.dtype(np.float32),
        encoding="32FC1",
        meaning="depth along the optical axis",
        unit="m",
        invalid="+inf nothing hit, NaN nearer than the near plane",
        display="depth",
        source="annotation",
        by_default=True,
        color_topic=True,
        png_per_unit=1000.0,
    ),
    ViewSpec(
        name="category",
        dtype=np.dtype(np.uint8),
        encoding="8UC1",
        wide_dtype=np.dtype(np.uint16),
        wide_encoding="16UC1",
        meaning="category id",
        invalid="0 background, 255 unlabelled",
        display="category",
        source="annotation",
        by_default=True,
        color_topic=True,
        compressed_topic="png",
    ),
    ViewSpec(
        name="instance",
        dtype=np.dtype(np.uint16),
        encoding="16UC1",
        meaning="instance id",
        invalid="0 background",
        display="instance",
        source="annotation",
        by_default=True,
        color_topic=True,
        compressed_topic="png",
    ),
    ViewSpec(
        name="flow",
        dtype=np.dtype(np.float32),
        channels=2,
        encoding="32FC2",
        meaning="velocity in the image, u right, v down",
        unit="px/s",
        invalid="NaN where it does not exist",
        display="flow",
        source="annotation",
        needs_past=True,
        by_default=True,
        color_topic=True,
    ),
    ViewSpec(
        name="flow_valid",
        dtype=np.dtype(np.bool_),
        encoding="8UC1",
        meaning="True where the surface point had a place in the previous frame's image plane",
        display="mask",
        source="annotation",
        needs_past=True,
        validity_of="flow",
    ),
    ViewSpec(
        name="occlusion",
        dtype=np.dtype(np.bool_),
        encoding="8UC1",
        meaning="True where the surface point was not visible in the previous frame",
        display="mask",
        source="annotation",
        needs_past=True,
        needs_past_depth=True,
    ),
    ViewSpec(
        name="normals",
        dtype=np.dtype(np.float32),
        channels=3,
        encoding="32FC3",
        meaning="unit surface normal in the optical frame",
        invalid="0 nothing hit",
        display="direction",
        source="geometry",
    ),
    ViewSpec(
        name="albedo",
        dtype=np.dtype(np.float32),
        channels=3,
        encoding="32FC3",
        meaning="base colour of the surface, whatever its light: red, green, blue (linear)",
        invalid="0 nothing hit",
        display="colour",
        source="geometry",
    ),
    ViewSpec(
        name="object_coords",
        dtype=np.dtype(np.float32),
        channels=3,
        encoding="32FC3",
        meaning="surface point in its instance's own frame",
        unit="m",
        invalid="NaN nothing hit or nearer than the near plane",
        display="place",
        source="annotation",
    ),
    ViewSpec(
        name="flow_forward",
        dtype=np.dtype(np.float32),
        channels=2,
        encoding="32FC2",
        meaning="displacement in the image to the next frame, u right, v down",
        unit="px",
        invalid="NaN where it does not exist",
        display="flow",
        source="motion",
        needs_next=True,
    ),
    ViewSpec(
        name="scene_flow",
        dtype=np.dtype(np.float32),
        channels=3,
        encoding="32FC3",
        meaning="displacement of the surface point in the world to the next frame, optical axes",
        unit="m",
        invalid="NaN where it does not exist",
        display="displacement",
        source="motion",
        needs_next=True,
    ),
)

VIEWS: Mapping[str, ViewSpec] = MappingProxyType({spec.name: spec for spec in _SPECS})
"""Every view by name."""

FIVE_VIEWS: tuple[str, ...] = tuple(name for name, spec in VIEWS.items() if spec.by_default)
"""What an agent gets unless it asks otherwise."""


ALWAYS_MADE: tuple[str, ...] = ("depth",)
"""What costs nothing beside any other view: for a frame of which only the camera is wanted."""

RENDERED_VIEWS: tuple[str, ...] = tuple(name for name, spec in VIEWS.items() if not spec.needs_next)
"""What a frame can have when it is made."""


def view_spec(name: str) -> ViewSpec:
    """Return the entry of one view.

    Raises
    ------
    UnknownName
        If there is no view of that name.
    """
    if name not in VIEWS:
        raise UnknownName("view", name, VIEWS)
    return VIEWS[name]


def views_of(*sources: ViewSource) -> tuple[str, ...]:
    """Return the views that one of these sources makes, in the order of `VIEWS`."""
    return tuple(name for name, spec in VIEWS.items() if spec.source in sources)


def checked_views(
    names: Iterable[str], *, supported: Collection[str] | None = None
) -> tuple[str, ...]:
    """Check names of views: known, at least one, each once; in the order of `VIEWS`.

    Parameters
    ----------
    names : iterable of str
    supported : collection of str or None
        What the renderer can make; None if that is not known here.

    Raises
    ------
    UnknownName
        If a name is not in `VIEWS`.
    InvalidRequest
        If there is none, or one that the renderer cannot make.
    """
    wanted = set(names)
    for name in sorted(wanted):
        view_spec(name)
    if not wanted:
        raise InvalidRequest("views", (), f"at least one of: {', '.join(VIEWS)}")
    ordered = tuple(name for name in VIEWS if name in wanted)
    missing = [] if supported is None else [name for name in ordered if name not in supported]
    late = [name for name in missing if VIEWS[name].needs_next]
    if late:
        raise InvalidRequest(
            "views",
            late,
            "views that are known with the frame itself; these are known with the next one: take "
            "motion(frame, next_frame), a recording or their topics",
        )
    if supported is not None and missing:
        offered = ", ".join(name for name in VIEWS if name in supported)
        raise InvalidRequest("views", missing, f"among those that this renderer makes: {offered}")
    return ordered


class DrawAlone(Protocol):
    """Draws the objects of a frame, each alone."""

    def __call__(self, only: int = 0) -> AmodalMasks:
        """Draw the object of that id, perhaps others too; 0 draws all."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """All views of one camera at one instant.

    Attributes
    ----------
    agent : str
        Whose camera.
    scene : str
    epoch, revision : int
        Of the scene_info that was true when it was made.
    sequence : int
        Counts this agent's frames from 1.
    stamp_ns : int
        Simulated time [ns].
    dt_ns : int
        Simulated time since the frame that flow refers to [ns]; 0 if there is none.
    camera : Camera
    depth_range_m : float
        Depth that the 8-bit depth picture shows as black [m].
    views : mapping of str to array
        Arrays as `VIEWS` says, read-only, never written again.
    timings_s : mapping of str to float
        Wall time of each stage of making it [s]; ``render`` is the whole.
    info : SceneInfo or None
        The scene at the frame's own instant; None if that is not known (it was not recorded).
    states : InstanceStates or None
        Poses and velocities of all instances at the frame's own instant; None if they were not
        recorded.
    randomised : mapping or None
        Record of what was drawn at random for it, which `randomise` takes; None if nothing was.
    draw_alone : callable or None
        Draws each object of the frame alone, as `amodal` gives it; None if nothing can.
    """

    agent: str
    scene: str
    epoch: int
    revision: int
    sequence: int
    stamp_ns: int
    dt_ns: int
    camera: Camera
    depth_range_m: float = 10.0
    views: Mapping[str, NDArray[Any]]
    timings_s: Mapping[str, float] = field(default_factory=dict)
    info: SceneInfo | None = None
    states: InstanceStates | None = None
    randomised: Mapping[str, Any] | None = None
    draw_alone: DrawAlone | None = None

    def __post_init__(self) -> None:
        height, width = self.camera.intrinsics.height, self.camera.intrinsics.width
        for name, array in self.views.items():
            spec = view_spec(name)
            shape = spec.shape(height, width)
            if array.shape != shape or array.dtype not in spec.dtypes:
                types = " or ".join(map(str, spec.dtypes))
                raise ValueError(
                    f"view {name} must be {shape} {types}, got {array.shape} {array.dtype}"
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

    @property
    def instances(self) -> dict[int, SceneObject]:
        """The objects that there were at the frame's instant, by their ids in its instance view.

        Empty if the scene of that instant is not known.
        """
        return {} if self.info is None else dict(self.info.objects)

    @cached_property
    def objects(self) -> ObjectTable:
        """What is known of every object of the scene at the frame's instant, seen or not.

        Raises
        ------
        InvalidState
            If the scene of that instant is not known.
        """
        from sailenv_ros.object_truth.frame_objects import objects_of

        return objects_of(self)

    @cached_property
    def amodal(self) -> AmodalMasks:
        """What each object covers, whatever lies in front of it: drawn when it is asked for first.

        Raises
        ------
        InvalidState
            If the frame's objects cannot be drawn alone: amodal masks were not recorded, or the
            simulator has rendered a later frame of that agent.
        SimulationClosed
            If the simulation has ended.
        """
        if self.draw_alone is None:
            raise InvalidState(
                "the frame has no amodal masks: ask a frame of a Simulation or of an Agent for "
                "them, or record them"
            )
        return self.draw_alone()

    def amodal_of(self, instance_id: int) -> AmodalMasks:
        """Return what one object covers, perhaps among others; quicker than `amodal`.

        Raises
        ------
        InvalidRequest
            If there is no object of that id.
        InvalidState, SimulationClosed
            As `amodal`.
        """
        if self.draw_alone is None or "amodal" in self.__dict__:
            return self.amodal
        return self.draw_alone(instance_id)

    @property
    def objects_with_amodal(self) -> ObjectTable:
        """The table of `objects` with the columns of `amodal`; see both for errors."""
        return self.objects.with_amodal(self.amodal)

    def keypoints(self, instance_id: int) -> Keypoints:
        """Return the named points of an object; the corners of its box if its asset names none.

        Raises
        ------
        InvalidRequest, InvalidState
            If there is no object of that id, or the scene is not known.
        """
        from sailenv_ros.object_truth.frame_objects import keypoints_of

        return keypoints_of(self, instance_id)

    def points(self, *, in_world: bool = True) -> PointCloud:
        """Return the points that the pixels see, with their colours and labels.

        Parameters
        ----------
        in_world : bool
            False gives points in the camera's optical frame.

        Raises
        ------
        UnknownName
            If the frame has no depth.
        """
        from sailenv_ros.object_truth.point_cloud import points_of

        return points_of(self, in_world=in_world)

    def to_dict(self, *, copy: bool = True) -> dict[str, Any]:
        """Return the frame as the dict of the SAILenv client, with more in it.

        Parameters
        ----------
        copy : bool
            False hands this frame's own arrays over: nobody else may hold them, and the frame must
            not be used afterwards.

        Returns
        -------
        frame : dict
            See `sailenv_ros.pictures.frame_dict.frame_dict`; every array is the caller's own.
        """
        from sailenv_ros.pictures.frame_dict import frame_dict  # which knows how views are shown

        return frame_dict(self, copy=copy)

    def _repr_html_(self) -> str:
        """Return the views as pictures, for notebooks."""
        from sailenv_ros.notebook import frame_html

        return frame_html(self)
