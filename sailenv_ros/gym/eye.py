"""Views as observations: their spaces, and arrays without values that break training.

As `docs/conventions.md` has them, but for what no network takes: NaN becomes 0, depth beyond a
limit that limit, and what has no bound is cut off at a large one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.gym.retina import Retina
from sailenv_ros.gym.room import Room
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.listed_views import Views, listed_views
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.validation import Bounds
from sailenv_ros.types.views import RENDERED_VIEWS, VIEWS, checked_views

__all__ = ["DEPTH_LIMIT", "Eye", "Look"]

DEPTH_LIMIT = Bounds(above=0.0, most=1000.0, unit="m")
"""Largest depths of observations that may be asked for."""

FASTEST_PX_S = 1e5
"""Largest speed in an observation of optical flow [px/s]."""

FARTHEST = 1e4
"""Largest coordinate in an observation."""

_SIGNED = {"normals": 1.0, "uv": FARTHEST, "object_coords": FARTHEST, "flow": FASTEST_PX_S}
_UNIT = frozenset({"albedo", "metallic_roughness"})
_REACH = frozenset({"depth", "range", "measured_depth"})


@dataclass(frozen=True, eq=False, slots=True)
class Look:
    """Result of one look.

    Attributes
    ----------
    views : mapping of str to array
        The views of the eye, and those that were asked for besides, as `VIEWS` has them.
    past : Observation
        What the next look compares with.
    """

    views: Mapping[str, NDArray[Any]]
    past: Observation


class Eye:
    """A camera's lens and the views that are observed through it.

    Parameters
    ----------
    views : str or iterable of str
        Names in `sailenv_ros.types.views.VIEWS`, in their order there.
    intrinsics : CameraIntrinsics
    picture : PictureSettings
    most_depth_m : float
        Largest depth and range [m]; all beyond, and nothing at all, counts as that.
    retina : (2,) tuple of int or None
        Rings and wedges of a `Retina` that views are seen by; None sees pixels.

    Attributes
    ----------
    views : tuple of str
    spaces : dict of str to gymnasium.spaces.Box
        Of each view.
    """

    def __init__(
        self,
        views: Views,
        intrinsics: CameraIntrinsics,
        picture: PictureSettings,
        most_depth_m: float = 10.0,
        retina: tuple[int, int] | None = None,
    ) -> None:
        if not isinstance(intrinsics, CameraIntrinsics):
            raise InvalidRequest("intrinsics", intrinsics, "an object of CameraIntrinsics")
        self.views = checked_views(listed_views(views), supported=RENDERED_VIEWS)
        self.intrinsics = intrinsics
        self.picture = PictureSettings.checked("picture", picture)
        self.most_depth_m = DEPTH_LIMIT.number("most_depth_m", most_depth_m)
        self._retina: Retina | None = None
        if retina is not None:
            if not isinstance(retina, tuple | list) or len(retina) != 2:
                raise InvalidRequest("retina", retina, "two integers: rings, wedges")
            self._retina = Retina(intrinsics.width, intrinsics.height, *retina)
        self.spaces = {name: self._space(name) for name in self.views}

    def look(
        self,
        room: Room,
        scene: WorldSnapshot,
        pose: Pose,
        past: Observation | None,
        also: frozenset[str] = frozenset(),
    ) -> Look:
        """Look at a scene of a room from somewhere.

        Parameters
        ----------
        room : Room
        scene : WorldSnapshot
            Of that room.
        pose : Pose
            Of the camera's body.
        past : Observation or None
            The look before, which motion is measured from.
        also : frozenset of str
            More views, which are not observed.
        """
        camera = Camera(intrinsics=self.intrinsics, pose=pose, picture=self.picture)
        wanted = also.union(self.views)
        made = room.renderer.render(RenderRequest(scene, camera, wanted, past))
        return Look(made.views, Observation(snapshot=scene, camera=camera, depth=made.depth))

    def write(self, views: Mapping[str, NDArray[Any]], out: Mapping[str, NDArray[Any]]) -> None:
        """Write the observed views into arrays of their spaces."""
        for name in self.views:
            view = views[name]
            if self._retina is not None:
                view = self._retina.sample(view, mean=name == "rgb")
            if name in _REACH:
                np.copyto(out[name], view)
                np.nan_to_num(out[name], copy=False, nan=0.0, posinf=self.most_depth_m)
                np.clip(out[name], 0.0, self.most_depth_m, out=out[name])
            elif name in _SIGNED:
                most = _SIGNED[name]
                np.copyto(out[name], view)
                np.nan_to_num(out[name], copy=False, nan=0.0, posinf=most, neginf=-most)
                np.clip(out[name], -most, most, out=out[name])
            elif name in _UNIT:
                np.clip(view, 0.0, 1.0, out=out[name])
            elif view.dtype != VIEWS[name].dtype:
                raise InvalidRequest("room", name, "a scene whose category ids are at most 255")
            else:
                out[name][...] = view

    def _space(self, name: str) -> spaces.Box:
        spec = VIEWS[name]
        lens, retina = self.intrinsics, self._retina
        size = (lens.height, lens.width) if retina is None else (retina.rings, retina.wedges)
        shape = spec.shape(*size)
        if name in _REACH:
            return spaces.Box(0.0, self.most_depth_m, shape, np.float32)
        if name in _SIGNED:
            return spaces.Box(-_SIGNED[name], _SIGNED[name], shape, np.float32)
        if name in _UNIT:
            return spaces.Box(0.0, 1.0, shape, np.float32)
        if spec.dtype == np.bool_:
            return spaces.Box(0, 1, shape, np.uint8)
        return spaces.Box(0, np.iinfo(spec.dtype).max, shape, spec.dtype.type)
