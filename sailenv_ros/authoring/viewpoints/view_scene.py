"""Parts of a camera rule, and the queries that a rule may make of a scene.

A rule is one function on a `ViewScene`, settings and random numbers: the same of these give the
same poses.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from sailenv_ros.authoring.viewpoints.object_targets import boxes_of
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.space import FreeSpace
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import ROOM_PARTS
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["CameraRule", "CameraView", "RuleSettings", "ViewScene", "camera_rule"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraView:
    """A pose that a rule has chosen.

    Attributes
    ----------
    pose : Pose
        Of the camera's body: x along the optical axis.
    target_id : int
        Instance id of the object that it looks at; 0 for none in particular.
    """

    pose: Pose
    target_id: int = 0


class ViewScene(ABC):
    """A scene at one instant as rules see it, through one lens.

    Attributes
    ----------
    snapshot : WorldSnapshot
    lens : CameraIntrinsics
    """

    def __init__(self, snapshot: WorldSnapshot, lens: CameraIntrinsics) -> None:
        self.snapshot = snapshot
        self.lens = lens
        self._last: tuple[Pose, Mapping[str, NDArray[Any]]] | None = None

    @abstractmethod
    def draw(self, camera: Camera, *views: str) -> Mapping[str, NDArray[Any]]:
        """Return these views of the scene, with no motion in them."""

    @abstractmethod
    def draw_amodal(self, camera: Camera, only: int) -> AmodalMasks:
        """Return each object drawn alone, or only the one of that id; 0 for all."""

    def instances(self, pose: Pose) -> NDArray[np.uint16]:
        """Return the (H, W) instance view from a pose."""
        return self._surfaces(pose)["instance"]

    def depth_m(self, pose: Pose) -> NDArray[np.float32]:
        """Return the (H, W) depth view from a pose [m]."""
        return self._surfaces(pose)["depth"]

    def whole_pixels(self, pose: Pose, only: int = 0) -> Mapping[int, int]:
        """Return how many pixels each object would cover alone, by its id; or only one object.

        The part beyond the picture's borders is counted, up to a picture's size on each side.
        """
        masks = self.draw_amodal(self.camera(pose), only)
        return dict(zip(masks.ids.tolist(), masks.whole_pixels.tolist(), strict=True))

    @abstractmethod
    def free_space(self, body: BodySize) -> FreeSpace:
        """Return where a body can stand."""

    @cached_property
    def boxes(self) -> NDArray[np.float64]:
        """(N, 2, 3) the lowest and the highest corner of each instance in its own axes [m]."""
        return boxes_of(self.snapshot)

    @cached_property
    def object_ids(self) -> frozenset[int]:
        """Ids of what stands in the scene: not of floors, walls and other parts of rooms."""
        found = {d.instance.id: d.instance for d in self.snapshot.contents.instances}
        # The door of a cupboard is no door of a room.
        return frozenset(
            i.id for i in found.values() if found.get(i.parent, i).category not in ROOM_PARTS
        )

    def seen(self, pose: Pose, cover: float) -> Mapping[int, int]:
        """Return the pixels of each object that covers at least that share of the picture."""
        view = self.instances(pose)
        # Counting sixteen bits takes a tenth of what sorting them does.
        pixels = np.bincount(view.reshape(-1))
        ids = np.flatnonzero(pixels >= max(1.0, cover * view.size))
        pairs = zip(ids.tolist(), pixels[ids].tolist(), strict=True)
        return {id_: count for id_, count in pairs if id_ in self.object_ids}

    def filled(self, pose: Pose) -> float:
        """Return which share of the picture objects take: all but parts of the room."""
        return float(np.isin(self.instances(pose), list(self.object_ids)).mean())

    def camera(self, pose: Pose) -> Camera:
        """Return the lens at a pose."""
        return Camera(intrinsics=self.lens, pose=pose)

    def _surfaces(self, pose: Pose) -> Mapping[str, NDArray[Any]]:
        """Return depth and ids; rules ask for both, and what they cost is to draw the surfaces."""
        if self._last is None or self._last[0] is not pose:
            self._last = pose, self.draw(self.camera(pose), "depth", "instance")
        return self._last[1]


class RuleSettings(BaseModel):
    """Settings that every rule has; a rule's own are fields of a subclass."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    attempts: int = Field(
        default=200, ge=1, le=10_000, description="poses that are tried for each one that is wanted"
    )


Settings: TypeAlias = type[RuleSettings]
Choose: TypeAlias = Callable[[ViewScene, Any, int, np.random.Generator], list[CameraView]]


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraRule:
    """A kind of rule.

    Attributes
    ----------
    type : str
        Its name.
    settings : subclass of RuleSettings
    choose : callable
        ``choose(scene, settings, count, random)`` returns at most `count` views.
    """

    type: str
    settings: Settings
    choose: Choose

    @property
    def summary(self) -> str:
        """One line of what it chooses."""
        return (self.choose.__doc__ or "").strip().split("\n")[0]


def camera_rule(type_: str, settings: Settings) -> Callable[[Choose], CameraRule]:
    """Declare a rule: decorate the function that chooses."""
    return lambda choose: CameraRule(type=type_, settings=settings, choose=choose)
