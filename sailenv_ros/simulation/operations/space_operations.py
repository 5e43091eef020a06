"""Operations that ask about space: where a body can stand and walk, what rays meet."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.authoring.viewpoints.object_targets import boxes_in_world, boxes_of
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasSpace, HasWorld
from sailenv_ros.space import FreeSpace, RayCast
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import vector

__all__ = ["SpaceOperations"]

Point: TypeAlias = tuple[float, float, float]

MOST_RAYS = 1_000_000

_BODY: dict[str, Any] = {
    name: check.number for name in ("height_m", "radius_m", "resolution_m", "floor_m", "step_m")
}


def _rays(what: str, value: Any) -> NDArray[np.float64]:
    """Check one triple of numbers, or (R, 3) of them."""
    accepted = f"(3,) or (R, 3) finite numbers, of at most {MOST_RAYS} rays"
    try:
        array = np.array(value, np.float64, ndmin=2)
    except (TypeError, ValueError):
        raise InvalidRequest(what, value, accepted) from None
    if array.size == 0:
        return np.zeros((0, 3))
    if array.ndim != 2 or array.shape[1] != 3 or len(array) > MOST_RAYS:
        raise InvalidRequest(what, f"shape {array.shape}", accepted)
    if not np.isfinite(array).all():
        raise InvalidRequest(what, value, accepted)
    return array


def _directions(what: str, value: Any) -> NDArray[np.float64]:
    array = _rays(what, value)
    if not np.linalg.norm(array, axis=1).all():
        raise InvalidRequest(what, value, "directions of a length above 0")
    return array


def _place(what: str, value: Any) -> tuple[float, float, float]:
    """Check x, y, and z, which may be left out [m]."""
    flat = isinstance(value, list | tuple | np.ndarray) and len(value) == 2
    return vector(what, (*value, 0.0) if flat else value)


def _reach(what: str, value: Any) -> float:
    if value == math.inf:
        return math.inf
    length = check.number(what, value)
    if not length > 0.0:
        raise InvalidRequest(what, value, "a length above 0 [m]")
    return length


def _body(
    height_m: float, radius_m: float, resolution_m: float, floor_m: float, step_m: float
) -> BodySize:
    return BodySize(
        height_m=height_m,
        radius_m=radius_m,
        resolution_m=resolution_m,
        floor_m=floor_m,
        step_m=step_m,
    )


class SpaceOperations(Caller):
    """The space of the scene as it stands now.

    The body that is asked about is an upright cylinder upon a floor at `floor_m`; what rises above
    the floor by no more than `step_m` is stepped over. Collision shapes decide, so curtains and
    other things that nothing collides with are free space. Lengths are in metres.
    """

    @operation()
    @staticmethod
    def scene_bounds(core: HasWorld) -> tuple[Point, Point]:
        """Return the lowest and the highest corner of the box around everything that is drawn.

        What lies outside a room is left out.

        Returns
        -------
        low, high : (3,) tuples of float
            World frame [m]; the box has the world's axes, and the boxes of all objects in it.
            Both are (0, 0, 0) in a scene without objects.
        """
        snapshot = core.world.snapshot()
        inside = [drawn.outside is None for drawn in snapshot.contents.instances]
        if not any(inside):
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        boxes = boxes_in_world(boxes_of(snapshot)[inside], snapshot.world_from_body[inside])
        return vector("low", boxes[:, 0].min(axis=0)), vector("high", boxes[:, 1].max(axis=0))

    @operation(**_BODY)
    @staticmethod
    def free_space(
        core: HasSpace,
        height_m: float = 1.8,
        radius_m: float = 0.25,
        *,
        resolution_m: float = 0.05,
        floor_m: float = 0.0,
        step_m: float = 0.05,
    ) -> FreeSpace:
        """Return the map of where a body can stand; it knows ways and random poses, too.

        Parameters
        ----------
        height_m, radius_m : float
            Of the body, 0.01 to 100 and 0 to 10 [m].
        resolution_m : float
            Side of the map's cells, 0.005 to 1 [m].
        floor_m : float
            Height of the floor in the world [m].
        step_m : float
            What it steps over, below its height [m].

        Returns
        -------
        free_space : FreeSpace
        """
        body = _body(height_m, radius_m, resolution_m, floor_m, step_m)
        space = core.space.free_space(body)
        core.on_free_space(space)
        return space

    @operation(start=_place, goal=_place, **_BODY)
    @staticmethod
    def find_path(
        core: HasSpace,
        start: ArrayLike,
        goal: ArrayLike,
        height_m: float = 1.8,
        radius_m: float = 0.25,
        *,
        resolution_m: float = 0.05,
        floor_m: float = 0.0,
        step_m: float = 0.05,
    ) -> NDArray[np.float64]:
        """Return the way of a body from one place to another; see `free_space` for the body.

        Parameters
        ----------
        start, goal : (2,) or (3,) array-like
            x and y of its axis in the world; z is ignored [m].

        Returns
        -------
        positions : (N, 3) float64
            Corners of the way upon the floor, start and goal included [m].

        Raises
        ------
        InvalidRequest
            If one of the places is not free, or no path joins them.
        """
        body = _body(height_m, radius_m, resolution_m, floor_m, step_m)
        return core.space.free_space(body).path(start, goal)

    @operation(
        name=check.text,
        seed=check.optional(check.seed),
        reachable_from=check.optional(_place),
        **_BODY,
    )
    @staticmethod
    def random_pose(
        core: HasSpace,
        name: str = "",
        height_m: float = 1.8,
        radius_m: float = 0.25,
        *,
        seed: int | None = None,
        reachable_from: ArrayLike | None = None,
        resolution_m: float = 0.05,
        floor_m: float = 0.0,
        step_m: float = 0.05,
    ) -> Pose:
        """Return a random pose of a body in free space; see `free_space` for the body.

        Parameters
        ----------
        name : str
            What it is for: the same name and seed give the same pose in the same scene.
        seed : int or None
            None takes that of the scene.
        reachable_from : (2,) or (3,) array-like or None
            A place from which there is a way to it; None means the largest region [m].

        Returns
        -------
        pose : Pose
            Upon the floor, turned about z alone.

        Raises
        ------
        InvalidRequest
            If `reachable_from` is not free.
        InvalidState
            If nothing is free.
        """
        body = _body(height_m, radius_m, resolution_m, floor_m, step_m)
        used = core.seed if seed is None else seed
        return core.space.free_space(body).random_pose(
            name, seed=used, reachable_from=reachable_from
        )

    @operation(origins=_rays, directions=_directions, max_distance_m=_reach)
    @staticmethod
    def cast_rays(
        core: HasSpace,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        max_distance_m: float = math.inf,
    ) -> RayCast:
        """Return what rays meet first of what the views show.

        As in the views, glass is not met, holes of masked materials are passed, and the backs of
        one-sided surfaces are not there.

        Parameters
        ----------
        origins : (3,) or (R, 3) array-like
            In the world; one for all rays, or one for each [m].
        directions : (3,) or (R, 3) array-like
            In the world, of any length but 0; one for all rays, or one for each.
        max_distance_m : float
            What is farther is not met [m].

        Returns
        -------
        rays : RayCast
        """
        starts, ways = _rays("origins", origins), _directions("directions", directions)
        if len(starts) != len(ways) and 1 not in (len(starts), len(ways)):
            accepted = f"as many as there are origins ({len(starts)}), or one"
            raise InvalidRequest("number of directions", len(ways), accepted)
        starts, ways = (np.ascontiguousarray(a) for a in np.broadcast_arrays(starts, ways))
        cast = core.space.cast_rays(starts, ways)
        far = ~(cast.distances_m <= max_distance_m)
        cast.instance_ids[far], cast.distances_m[far] = 0, np.inf
        cast.points_m[far], cast.normals[far] = np.nan, 0.0
        return cast
