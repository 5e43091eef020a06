"""Update plan and projection of a shadow map; the same for every back end.

A snapshot, a light and the choice of what casts come in; out comes what is to be drawn, if
anything, and the matrix into the map. A map is drawn again only when something that it depends on
has changed; then what has not moved is copied from a second map, where it was drawn once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.scene.shadow_casters import CasterBoxes
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.lights import Light
from sailenv_ros.types.snapshot import (
    DrawnInstance,
    SceneContents,
    WorldSnapshot,
    steady_poses,
)

__all__ = ["SIZE_PX", "ShadowPlan", "ShadowRedraw"]

SETTLED_UPDATES = 10
"""Updates after which a thing that stands still is drawn into the second map, too."""

SIZE_PX = 1024


@dataclass(frozen=True, eq=False, slots=True)
class ShadowRedraw:
    """Drawing steps that bring a shadow map up to date.

    Attributes
    ----------
    poses : (N, 4, 4) float64
        Poses of the instances [m], as they count for the map.
    keep : bool
        True if the map as it is becomes the second one first.
    resting : (N,) bool or None
        What is to be drawn into the second map first; None if nothing is.
    clear : bool
        True if the second map is cleared before that, False if it is drawn over what is there.
    from_resting : bool
        True if the map begins as a copy of the second one, False if it begins empty.
    casters : (N,) bool
        What is drawn into the map then.
    """

    poses: NDArray[np.float64]
    casters: NDArray[np.bool_]
    keep: bool = False
    resting: NDArray[np.bool_] | None = None
    clear: bool = True
    from_resting: bool = False


class ShadowPlan:
    """The plan of one shadow map.

    Attributes
    ----------
    clip_from_light, light_from_world : (4, 4) float64
        Orthographic projection (OpenGL's clip axes), and the light's own axes.
    map_from_world : (4, 4) float64
        Place in the map, 0 to 1, and depth, 0 to 1.
    texel_m : float
        Size of a texel [m].
    """

    def __init__(self) -> None:
        self._boxes = CasterBoxes()
        self._keys: list[tuple[object, ...]] = []
        self._contents: SceneContents | None = None
        self._direction: tuple[float, ...] = ()
        self._poses = np.zeros((0, 4, 4))
        self._shapes: Mapping[int, Deformation] = {}
        self._casting = self._framed = self._at_rest = np.zeros(0, bool)
        self._rest_poses = np.zeros((0, 4, 4))
        self._stood = np.zeros(0, np.intp)
        self._rest_drawn = self._shows_rest = False
        self._frame: tuple[object, ...] = ()
        self.clip_from_light: NDArray[np.float64] = np.eye(4)
        self.light_from_world: NDArray[np.float64] = np.eye(4)
        self.map_from_world: NDArray[np.float64] = np.eye(4)
        self.texel_m = 0.0

    def update(
        self,
        light: Light,
        snapshot: WorldSnapshot,
        *,
        casting: NDArray[np.bool_] | None = None,
        framed: NDArray[np.bool_] | None = None,
    ) -> ShadowRedraw | None:
        """Return what is to be drawn now; None if the map is as it should be.

        Parameters
        ----------
        casting : (N,) bool or None
            Which instances cast; None for all.
        framed : (N,) bool or None
            Which instances, that stand still, the map encloses; None for all.
        """
        self._follow(snapshot.contents)
        poses = _steady(snapshot)
        everything = np.ones(len(poses), bool)
        casting = everything if casting is None else casting
        still = framed is not None
        framed = everything if framed is None else framed
        same = (
            self._direction == light.direction
            and np.array_equal(self._casting, casting)
            and np.array_equal(self._framed, framed)
        )
        concerned = casting | framed
        deforming, reshaped = self._reshaped(snapshot)
        unchanged = same and not (reshaped & casting).any()
        if unchanged and np.array_equal(self._poses[concerned], poses[concerned]):
            return None
        moved = (poses != self._poses).any(axis=(1, 2)) if same else np.zeros(len(poses), bool)
        moved |= deforming  # what deforms is never taken to rest
        self._direction, self._poses, self._shapes = light.direction, poses, snapshot.deformations
        self._casting, self._framed = casting, framed
        self._fit(light, snapshot, poses, framed, still)
        if self._is_stale(casting):
            # Drawn apart only when it is needed a second time: what goes on moving never is.
            self._at_rest, self._rest_poses, self._rest_drawn = casting & ~moved, poses, False
            self._shows_rest = not (casting & moved).any()
            self._stood = np.zeros(len(poses), np.intp)
            return ShadowRedraw(poses, casting)
        self._stood = np.where(moved, 0, self._stood + 1)
        settled = casting & ~self._at_rest & (self._stood >= SETTLED_UPDATES)
        if self._rest_drawn and settled.any():
            self._at_rest |= settled
            self._rest_poses = np.where(settled[:, None, None], poses, self._rest_poses)
            others = casting & ~self._at_rest
            return ShadowRedraw(poses, others, resting=settled, clear=False, from_resting=True)
        keep = not self._rest_drawn and self._shows_rest
        resting = None if self._rest_drawn or keep else self._at_rest
        self._rest_drawn, self._shows_rest = True, False
        return ShadowRedraw(poses, casting & ~self._at_rest, keep, resting, from_resting=True)

    def _reshaped(self, snapshot: WorldSnapshot) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return (N,): which instances deform, and which have another shape than was drawn."""
        shapes, ids = snapshot.deformations, snapshot.contents.instance_ids
        changed = [key for key, shape in shapes.items() if self._shapes.get(key) is not shape]
        if not shapes:
            none = np.zeros(len(ids), bool)
            return none, none
        return np.isin(ids, list(shapes)), np.isin(ids, changed)

    def _follow(self, contents: SceneContents) -> None:
        """Find the instances of before among the rows of other contents."""
        if self._contents is contents:
            return
        same = self._contents is not None and self._contents.instances is contents.instances
        keys = self._keys if same else [_key(drawn) for drawn in contents.instances]
        if keys != self._keys:
            row_of = {key: row for row, key in enumerate(self._keys)}
            rows = np.array([row_of.get(key, -1) for key in keys], np.intp)
            gone = np.ones(len(self._keys), bool)
            gone[rows[rows >= 0]] = False
            if (gone & (self._casting | self._framed)).any():
                self._direction, self._frame = (), ()
            known = rows >= 0

            def brought(before: NDArray[np.bool_]) -> NDArray[np.bool_]:
                result = np.zeros(len(keys), bool)
                result[known] = before[rows[known]]
                return result

            def placed(before: NDArray[np.float64]) -> NDArray[np.float64]:
                result = np.full((len(keys), 4, 4), np.nan)
                result[known] = before[rows[known]]
                return result

            if (gone & _sized(self._at_rest, len(gone))).any():
                self._rest_drawn, self._at_rest = False, np.zeros(0, bool)
            self._casting, self._framed = brought(self._casting), brought(self._framed)
            self._poses = placed(self._poses)
            if len(self._at_rest) == len(gone):
                self._at_rest = brought(self._at_rest)
                self._rest_poses = placed(self._rest_poses)
            stood = np.zeros(len(keys), np.intp)
            if len(self._stood) == len(gone):
                stood[known] = self._stood[rows[known]]
            self._stood = stood
        # The number of a model is unique only while it lives: the contents keep it.
        self._contents, self._keys = contents, keys

    def _fit(
        self,
        light: Light,
        snapshot: WorldSnapshot,
        poses: NDArray[np.float64],
        framed: NDArray[np.bool_],
        still: bool,
    ) -> None:
        """Enclose the framed instances, if that is not done yet."""
        light_from_world = _light_axes(light)
        placed = light_from_world @ poses
        low, high = self._boxes.bounds(snapshot.contents, placed, framed, still=still)
        frame = light.direction, low.tobytes(), high.tobytes()
        if self._frame == frame:
            return
        self._frame = frame
        self._at_rest = np.zeros(0, bool)
        self.light_from_world = light_from_world
        self.clip_from_light, width_m = _projection(low, high)
        self.texel_m = width_m / SIZE_PX
        # From clip space, -1 to 1, to texture space, 0 to 1.
        half = np.diag([0.5, 0.5, 0.5, 1.0])
        half[:3, 3] = 0.5
        self.map_from_world = half @ self.clip_from_light @ self.light_from_world

    def _is_stale(self, casting: NDArray[np.bool_]) -> bool:
        """Return whether something that was drawn as resting has moved since, or casts no more."""
        rest = self._at_rest
        if len(rest) != len(casting) or (rest & ~casting).any():
            return True
        return not np.array_equal(self._poses[rest], self._rest_poses[rest])


def _steady(snapshot: WorldSnapshot) -> NDArray[np.float64]:
    """Return poses; of what moves those in steps, so that few of them need a new map."""
    poses, moving = snapshot.world_from_body, snapshot.moving
    if not moving.any():
        return poses
    return np.where(moving[:, None, None], steady_poses(poses), poses)


def _key(drawn: DrawnInstance) -> tuple[object, ...]:
    """Return a key that tells casters apart while their models live."""
    return drawn.instance.id, id(drawn.model), drawn.scale


def _sized(mask: NDArray[np.bool_], count: int) -> NDArray[np.bool_]:
    return mask if len(mask) == count else np.zeros(count, bool)


def _light_axes(light: Light) -> NDArray[np.float64]:
    """Return (4, 4): the axes of a map, the third along the light."""
    forward = np.asarray(light.direction)
    helper = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    right = np.cross(forward, helper)
    right /= np.linalg.norm(right)
    light_from_world = np.eye(4)
    light_from_world[:3, :3] = np.stack([right, np.cross(right, forward), forward])
    return light_from_world


def _projection(
    low: NDArray[np.float64], high: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Return (4, 4), orthographic, of a box along the light, and its width [m]."""
    width = float(max(high[0] - low[0], high[1] - low[1], 0.5)) * 1.05
    centre = 0.5 * (low + high)
    near, far = float(low[2]) - 0.5, float(high[2]) + 0.5
    clip = np.diag([2.0 / width, 2.0 / width, 2.0 / (far - near), 1.0])
    clip[:3, 3] = [
        -2.0 * centre[0] / width,
        -2.0 * centre[1] / width,
        -(far + near) / (far - near),
    ]
    return clip, width
