"""A frame: the bundle of views that one camera sees at one instant; `views` says what they are.

Comes from `render/` by way of `simulation.py`, goes to messages, sockets, files and windows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol

from numpy.typing import NDArray

from sailenv_ros.camera import Camera
from sailenv_ros.errors import InvalidState, UnknownName
from sailenv_ros.instance_states import InstanceStates
from sailenv_ros.lessons import LessonState
from sailenv_ros.views import (
    ALWAYS_MADE,
    FIVE_VIEWS,
    RENDERED_VIEWS,
    VIEWS,
    ImageCodec,
    ViewDisplay,
    ViewSource,
    ViewSpec,
    checked_views,
    view_spec,
    views_of,
)

if TYPE_CHECKING:
    from sailenv_ros.object_truth import AmodalMasks, Keypoints, ObjectTable, PointCloud
    from sailenv_ros.scene_info import SceneInfo, SceneObject  # which knows what agents see

__all__ = [
    "ALWAYS_MADE",
    "FIVE_VIEWS",
    "VIEWS",
    "DrawAmodal",
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


class DrawAmodal(Protocol):
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
    lesson : LessonState or None
        Which lesson it is of; None if the scene has none.
    draw_amodal : callable or None
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
    lesson: LessonState | None = None
    draw_amodal: DrawAmodal | None = None

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
        # In one order, whoever made them: what is written of a frame is the same bytes each time.
        ordered = {name: self.views[name] for name in VIEWS if name in self.views}
        object.__setattr__(self, "views", MappingProxyType(ordered))

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
        if self.draw_amodal is None:
            raise InvalidState(
                "the frame has no amodal masks: ask a frame of a Simulation or of an Agent for "
                "them, or record them"
            )
        return self.draw_amodal()

    def amodal_of(self, instance_id: int) -> AmodalMasks:
        """Return what one object covers, perhaps among others; quicker than `amodal`.

        Raises
        ------
        InvalidRequest
            If there is no object of that id.
        InvalidState, SimulationClosed
            As `amodal`.
        """
        if self.draw_amodal is None or "amodal" in self.__dict__:
            return self.amodal
        return self.draw_amodal(instance_id)

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
