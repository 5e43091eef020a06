"""The data of a frame: the views that one camera sees at one instant, and what is known with them.

Comes from `render/` through `simulation/`, goes to messages, sockets, files and windows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from numpy.typing import NDArray

from sailenv_ros.errors import UnknownName
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.lessons import LessonState
from sailenv_ros.types.rebuilding import RebuiltByFields
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.scene_info import SceneInfo, SceneObject
from sailenv_ros.types.views import VIEWS, view_spec

if TYPE_CHECKING:
    from sailenv_ros.frame.language.scene_facts import SceneFacts
    from sailenv_ros.frame.truth.amodal_masks import AmodalMasks

__all__ = ["DrawAmodal", "FrameData"]

F = TypeVar("F", bound="FrameData")


class DrawAmodal(Protocol):
    """Draws the objects of a frame, each alone."""

    def __call__(self, only: int = 0) -> AmodalMasks:
        """Draw the object of that id, perhaps others too; 0 draws all."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FrameData(RebuiltByFields, Mapping[str, NDArray[Any]]):
    """All views of one camera at one instant: a mapping of their names to arrays.

    Can be copied and sent to other processes; what drew amodal masks stays where it is.

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
    row_poses : RowPoses or None
        Poses by rows where a shutter rolled and something moved; None if all rows saw one instant,
        or they are not known (files of data sets do not have them).
    exposure : float
        Stops that the picture was brightened by, besides the scene's.
    facts : SceneFacts or None
        What touches, lies in what and is made of what at its instant; None if nobody asked.
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
    row_poses: RowPoses | None = None
    exposure: float = 0.0
    facts: SceneFacts | None = None

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

    def __contains__(self, view: object) -> bool:
        return view in self.views

    def __iter__(self) -> Iterator[str]:
        return iter(self.views)

    def __len__(self) -> int:
        return len(self.views)

    # A frame is equal to itself alone, as any object is: comparing pictures is up to the caller.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __bool__(self) -> bool:
        return True  # also without views: a frame without views is a frame

    def field_values(self) -> dict[str, Any]:
        """Return the arguments of the constructor that make an equal frame in any process."""
        return {**super().field_values(), "views": dict(self.views), "draw_amodal": None}

    def __copy__(self: F) -> F:
        return replace(self, draw_amodal=self.amodal_source)

    def __deepcopy__(self: F, memo: dict[int, Any]) -> F:
        values = deepcopy(self.field_values(), memo)
        return type(self)(**{**values, "draw_amodal": self.amodal_source})

    @property
    def amodal_source(self) -> DrawAmodal | None:
        """Source of amodal masks for a copy in this process."""
        return self.draw_amodal

    @property
    def about(self) -> str:
        """A line that says whose frame it is, of when, and how large."""
        lens = self.camera.intrinsics
        return (
            f"{self.agent} in {self.scene}: frame {self.sequence}, "
            f"t = {self.stamp_ns * 1e-9:.3f} s, Δt = {self.dt_s:.3f} s, "
            f"{lens.width} × {lens.height} px"
        )

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.about}\n views: {', '.join(self.views) or 'none'}>"

    def get(self, view: str, default: Any = None) -> Any:
        """Return a view; the default if the frame does not have it."""
        return self.views.get(view, default)

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
