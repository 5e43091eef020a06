"""Tracks of surface points through frames: where they are in picture and space, if they are seen.

Pixels or points on objects, frames, and the scene's geometry in; arrays out. What is seen is
decided by rays against the scene's triangles at each frame's instant: no view of a frame is read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.lens_rays import reach_lines, reach_of_points
from sailenv_ros.frame.motion.deforming_points import at_instant, at_rest
from sailenv_ros.frame.motion.frame_state import (
    AnyFrame,
    FrameState,
    frame_state_of,
    require_common_past,
)
from sailenv_ros.rays.scene_geometry import SceneGeometry

__all__ = ["ObjectPoints", "Tracks", "track"]

Doubles = NDArray[np.float64]

SURFACE = 1e-4
"""Share of its distance by which the surface that a ray meets may lie beside a point that is on it:
points from an `object_coords` view are rounded to single precision."""


@dataclass(frozen=True, eq=False, slots=True)
class ObjectPoints:
    """Points on objects.

    Attributes
    ----------
    instances : (N,) integers
        Instance ids.
    coords : (N, 3) floats
        Places in each instance's own frame, as the view ``object_coords`` has them [m].
    """

    instances: ArrayLike
    coords: ArrayLike


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Tracks:
    """N points through T frames.

    Attributes
    ----------
    instances : (N,) uint16
        Whose surface each point is on; 0 for a pixel that shows nothing, which has no track.
    coords : (N, 3) float64
        Its place in that instance's own frame [m]; nan for none.
    pixels : (N, T, 2) float64
        Its place in each picture, columns and rows, also where it is hidden or beside the picture
        [px]; nan behind the camera, and where its instance is not there.
    positions : (N, T, 3) float64
        Its place in the world [m]; nan where its instance is not there.
    in_view : (N, T) bool
        Where it is within the picture, before the camera and not beyond its far plane.
    visible : (N, T) bool
        Where it is in view and what the ray to it meets first is its own surface.
    """

    instances: NDArray[np.uint16]
    coords: Doubles
    pixels: Doubles
    positions: Doubles
    in_view: NDArray[np.bool_]
    visible: NDArray[np.bool_]

    @property
    def occluded(self) -> NDArray[np.bool_]:
        """(N, T) bool: where it is not visible, for whatever reason; what TAP-Vid calls so."""
        return ~self.visible


def track(
    points: ArrayLike | ObjectPoints, frames: Sequence[AnyFrame], geometry: SceneGeometry
) -> Tracks:
    """Follow surface points through frames.

    Parameters
    ----------
    points : (N, 3) array or ObjectPoints
        Rows (number of the frame in `frames`, column, row): the point that this frame shows there;
        columns and rows may be fractions. Or points on objects.
    frames : sequence of Frame or dict
        Of one epoch of a scene; of one camera or of several.
    geometry : SceneGeometry
        Of the scene: ``SceneGeometry.of_contents(simulation.contents)``, or
        `sailenv_ros.simulation.recorded_geometry` for recordings.

    Returns
    -------
    tracks : Tracks

    Raises
    ------
    InvalidRequest
        If there is no frame, a pixel is not within its picture, an instance is not in the geometry,
        or frames do not belong together.
    """
    moments = [frame_state_of(frame, f"frame {number}") for number, frame in enumerate(frames)]
    if not moments:
        raise InvalidRequest("frames", "none", "at least one")
    for moment in moments[1:]:
        require_common_past(moments[0], moment)
    if isinstance(points, ObjectPoints):
        instances, coords, histories = _given(points, moments)
    else:
        instances, coords, histories = _found(points, moments, geometry)
    count, length = len(instances), len(moments)
    tracks = Tracks(
        instances=instances,
        coords=coords,
        pixels=np.full((count, length, 2), np.nan),
        positions=np.full((count, length, 3), np.nan),
        in_view=np.zeros((count, length), np.bool_),
        visible=np.zeros((count, length), np.bool_),
    )
    for number, moment in enumerate(moments):
        _follow(tracks, histories, number, moment, geometry)
    return tracks


def _given(
    points: ObjectPoints, moments: Sequence[FrameState]
) -> tuple[NDArray[np.uint16], Doubles, NDArray[np.int64]]:
    """Return instances, places in them and histories of points on objects."""
    instances = np.asarray(points.instances)
    coords = np.asarray(points.coords, np.float64)
    if instances.ndim != 1 or coords.shape != (len(instances), 3):
        shapes = f"shapes {instances.shape} and {coords.shape}"
        raise InvalidRequest("points on objects", shapes, "instances (N,) and coords (N, 3)")
    histories = np.full(len(instances), -1, np.int64)
    for moment in reversed(moments):
        # The history of the first frame in which it is there counts.
        rows = moment.states.row_of_id[np.clip(instances, 0, 65535).astype(np.int64)]
        there = (rows >= 0) & (instances > 0)
        histories[there] = moment.states.histories[rows[there]]
    if np.any(histories < 0):
        unknown = instances[histories < 0][0]
        raise InvalidRequest("instance id", unknown, "the id of an instance in one of the frames")
    return instances.astype(np.uint16), coords.copy(), histories


def _found(
    points: ArrayLike, moments: Sequence[FrameState], geometry: SceneGeometry
) -> tuple[NDArray[np.uint16], Doubles, NDArray[np.int64]]:
    """Return instances, places in them and histories of what pixels show."""
    queries = np.asarray(points, np.float64)
    if queries.ndim != 2 or queries.shape[1] != 3 or not np.isfinite(queries).all():
        accepted = "finite rows (number of the frame, column, row), or ObjectPoints"
        raise InvalidRequest("points", f"shape {queries.shape}", accepted)
    numbers = queries[:, 0].astype(np.int64)
    if np.any(numbers != queries[:, 0]) or np.any((numbers < 0) | (numbers >= len(moments))):
        raise InvalidRequest("number of a frame", numbers, f"0 to {len(moments) - 1}")
    instances = np.zeros(len(queries), np.uint16)
    coords = np.full((len(queries), 3), np.nan)
    histories = np.zeros(len(queries), np.int64)
    for number in np.unique(numbers):
        rows = np.flatnonzero(numbers == number)
        moment, pixels = moments[number], queries[rows, 1:]
        lens, states = moment.camera.intrinsics, moment.states
        if not _within(pixels, moment).all():
            accepted = f"within the picture: -0.5 to {lens.width - 0.5} and {lens.height - 0.5}"
            raise InvalidRequest("pixel", pixels[~_within(pixels, moment)][0], accepted)
        origins, rays = reach_lines(lens, pixels)
        turn = moment.camera.world_from_camera[:3, :3]
        directions = rays @ turn.T
        eye = origins @ turn.T + moment.camera.world_from_camera[:3, 3]
        hits = geometry.cast(states, eye, directions)
        # Distances are depths, or along the rays, as clip distances are.
        met = np.flatnonzero((hits.instance > 0) & (hits.distance <= lens.far_m))
        at = states.row_of_id[hits.instance[met]]
        world = eye[met] + directions[met] * hits.distance[met, None]
        matrices = states.matrices[at]
        instances[rows[met]] = hits.instance[met]
        own = np.einsum("nji,nj->ni", matrices[:, :3, :3], world - matrices[:, :3, 3])
        coords[rows[met]] = at_rest(own, instances[rows[met]], states)
        histories[rows[met]] = states.histories[at]
    return instances, coords, histories


def _follow(
    tracks: Tracks,
    histories: NDArray[np.int64],
    number: int,
    moment: FrameState,
    geometry: SceneGeometry,
) -> None:
    """Fill in one frame of the tracks."""
    states, camera = moment.states, moment.camera
    rows = states.row_of_id[tracks.instances]
    there = (rows >= 0) & (tracks.instances > 0)
    there[there] = states.histories[rows[there]] == histories[there]
    chosen = np.flatnonzero(there)
    matrices = states.matrices[rows[chosen]]
    coords = at_instant(tracks.coords[chosen], tracks.instances[chosen], states)
    world = np.einsum("nij,nj->ni", matrices[:, :3, :3], coords) + matrices[:, :3, 3]
    eye = camera.world_from_camera[:3, 3]
    optical = (world - eye) @ camera.world_from_camera[:3, :3]
    pixels = camera.intrinsics.project(optical)
    reach = reach_of_points(optical, camera.intrinsics)
    seen = _within(pixels, moment) & (reach <= camera.intrinsics.far_m)
    tracks.positions[chosen, number] = world
    tracks.pixels[chosen, number] = pixels
    tracks.in_view[chosen, number] = seen
    asked = np.flatnonzero(seen)
    if camera.intrinsics.is_parallel:
        axis = camera.world_from_camera[:3, 2]
        origins = world[asked] - reach[asked, None] * axis
    else:
        origins = np.broadcast_to(eye, (len(asked), 3))
    hits = geometry.cast(states, origins, world[asked] - origins)
    own = hits.instance == tracks.instances[chosen[asked]]
    tracks.visible[chosen[asked], number] = own & (np.abs(hits.distance - 1.0) <= SURFACE)


def _within(pixels: Doubles, moment: FrameState) -> NDArray[np.bool_]:
    """Return which places (N, 2) lie within the picture; nan does not."""
    lens = moment.camera.intrinsics
    inside = (pixels >= -0.5) & (pixels <= np.array([lens.width - 0.5, lens.height - 0.5]))
    return np.asarray(inside.all(axis=-1), np.bool_)
