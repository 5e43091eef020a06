"""Whether a generated room is as promised: nothing intersects, all stands still, all is seen.

A built `World` in, names of objects at fault out, with what is wrong. The world is stepped.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.selection import make_backend
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.world.physics_check import obstructions, overlaps, shifts
from sailenv_ros.world.world import World

__all__ = ["Fault", "faults", "look_backend", "unseen"]

STILL_M = 0.004
STILL_DEG = 2.0
"""Greatest motion of an object in two seconds at which it still counts as standing [m], [deg]."""

NEAR_M = 0.08
"""Greatest distance of a resting object from its planned place [m]."""

LEAST_PIXELS = 3
_LOOK_PX = (240, 180)
_LOOKS = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """Something that is not as promised.

    Attributes
    ----------
    names : tuple of str
        Objects of which one has to go.
    why : str
    rests_at : Pose or None
        Where an object has come to rest that did not stay where it was.
    """

    names: tuple[str, ...]
    why: str
    rests_at: Pose | None = None


def faults(world: World) -> Iterator[Fault]:
    """Yield what intersects, what is in the camera's way, and what does not stand still."""
    for overlap in overlaps(world):
        why = f"overlap by {1000.0 * overlap.depth_m:.0f} mm"
        yield Fault(names=(overlap.first, overlap.second), why=why)
    for way in obstructions(world):
        yield Fault(names=(way.name,), why="is in the camera's way")
    moved = list(shifts(world, distance_m=STILL_M, angle_deg=STILL_DEG))
    now = {body.placement.name: body.world_from_body() for body in world.bodies}
    for shift in moved:
        rests = Pose.from_matrix(now[shift.name]) if shift.distance_m < NEAR_M else None
        why = f"moves by {1000.0 * shift.distance_m:.0f} mm and turns by {shift.angle_deg:.0f} deg"
        yield Fault(names=(shift.name,), why=why, rests_at=rests)


def unseen(
    world: World, eyes: Sequence[tuple[float, float, float]], backend: RenderBackend
) -> Iterator[Fault]:
    """Yield the objects that are seen from none of some places.

    Parameters
    ----------
    world : World
    eyes : sequence of (3,) tuple of float
        Where one looks around, in all directions [m].
    backend : RenderBackend
        See `look_backend`.
    """
    snapshot = world.snapshot()
    bodies = {
        number: body
        for number, body in world.bodies_by_id.items()
        if body.placement.entry is not None
        and not body.placement.asset.opens  # behind a door that is shut, it may be hidden
    }
    # An object is seen where a part of it is.
    wholes = {drawn.instance.id: drawn.instance.parent for drawn in snapshot.contents.instances}
    missing = set(bodies)

    def look(eye: tuple[float, float, float], at: tuple[float, ...], angle_deg: float) -> None:
        lens = CameraIntrinsics(width=_LOOK_PX[0], height=_LOOK_PX[1], vertical_fov_deg=angle_deg)
        camera = Camera(intrinsics=lens, pose=look_at(eye, at))
        ids = backend.render(RenderRequest(snapshot, camera, ("instance",))).views["instance"]
        found, counts = np.unique(ids, return_counts=True)
        seen = found[counts >= LEAST_PIXELS].tolist()
        missing.difference_update(seen, (wholes.get(number, 0) for number in seen))

    for eye in eyes:
        for turn in range(4):
            yaw = math.radians(90.0 * turn + 20.0)
            if missing:
                look(eye, (eye[0] + math.cos(yaw), eye[1] + math.sin(yaw), eye[2] - 0.1), 100.0)
    for number in sorted(missing):
        # Small things are seen by who looks at them.
        matrix = bodies[number].world_from_body()
        middle = bodies[number].placement.asset.model.middle
        at = tuple((matrix[:3, :3] @ middle + matrix[:3, 3]).tolist())
        for eye in sorted(eyes, key=lambda each: math.dist(each, at))[:_LOOKS]:
            if number in missing and math.dist(eye, at) > 0.1:
                look(eye, at, 30.0)
    for number in sorted(missing):
        yield Fault(names=(bodies[number].placement.name,), why="is seen from nowhere")


def look_backend() -> RenderBackend:
    """Return the renderer whose ids are the same on every machine."""
    return make_backend("native", None)
