"""Whether a scene is put together as was meant: what overlaps, what falls, what is in the way.

A built `World` in, diagnostics out. The world is stepped, so it is one for this alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sailenv_ros.types.geometry import matrix_angle_deg
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.gaps import gaps
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.world import World

__all__ = ["RUG_GIVES_M", "Obstruction", "Overlap", "Shift", "obstructions", "overlaps", "shifts"]

MOVER_RADIUS_M = 0.15
"""Room that a camera wants around it."""

RUG = "rug"
TRACK_STEP_S = 0.25

RUG_GIVES_M = 0.02
"""How far static furniture may stand in the pile of a rug [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlap:
    """Two objects that stand in one another, by so much [m]."""

    first: str
    second: str
    depth_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Shift:
    """An object that did not stay where it was put [m, deg]."""

    name: str
    distance_m: float
    angle_deg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Obstruction:
    """A mover whose track comes too near to an object, first at this time [s]."""

    mover: str
    name: str
    time_s: float
    clearance_m: float


def overlaps(world: World, *, tolerance_m: float = 0.002) -> Iterator[Overlap]:
    """Yield all pairs of objects that overlap by more than a tolerance, static ones too.

    The parts of a room stand in one another by construction; those pairs are left out. Rugs give
    way to static furniture.
    """
    for gap in gaps(world, 0.0, _belong_together):
        pair = [world.body(id_) for id_ in (gap.first, gap.second)]
        if -gap.gap_m > (RUG_GIVES_M if _in_a_rug(pair) else tolerance_m):
            first, second = (body.placement.name for body in pair)
            yield Overlap(first=first, second=second, depth_m=-gap.gap_m)


def shifts(
    world: World, *, seconds: float = 2.0, distance_m: float = 0.02, angle_deg: float = 5.0
) -> Iterator[Shift]:
    """Step the world, then yield what has moved or turned by more, though nothing drives it."""
    resting = [body for body in world.bodies if not body.placement.static and not body.behaviours]
    before = [body.world_from_body() for body in resting]
    for body in resting:
        body.wake()
    world.step(round(seconds * STEPS_PER_SECOND))
    for body, start in zip(resting, before, strict=True):
        now = body.world_from_body()
        moved = float(np.linalg.norm(now[:3, 3] - start[:3, 3]))
        turned = matrix_angle_deg(now[:3, :3] @ start[:3, :3].T)
        if moved > distance_m or turned > angle_deg:
            yield Shift(name=body.placement.name, distance_m=moved, angle_deg=turned)


def obstructions(world: World, *, radius_m: float = MOVER_RADIUS_M) -> Iterator[Obstruction]:
    """Yield what each mover's track passes nearer than a radius, once for each object."""
    client = world.client
    shape = client.createCollisionShape(client.constants.GEOM_SPHERE, radius=0.001)
    probe = client.createMultiBody(baseMass=0.0, baseCollisionShapeIndex=shape)
    try:
        for mover in world.movers.values():
            yield from _on_track(world, mover, probe, radius_m)
    finally:
        client.removeBody(probe)


def _on_track(world: World, mover: Mover, probe: int, radius_m: float) -> Iterator[Obstruction]:
    if mover.track is None:
        return
    seen: set[str] = set()
    bodies = [body for body in world.bodies if body.collides and not body.behaviours]
    boxes = np.reshape(
        [world.client.getAABB(body.bullet_id, body.link) for body in bodies], (-1, 2, 3)
    )
    for time_s in np.arange(0.0, mover.track.total_time_s, TRACK_STEP_S):
        position = mover.track.pose_at(float(time_s)).position_m
        world.client.resetBasePositionAndOrientation(probe, position, (0.0, 0.0, 0.0, 1.0))
        # No shape is nearer than the box around it.
        apart = np.maximum(boxes[:, 0] - position, position - boxes[:, 1])
        for place in np.flatnonzero((apart < radius_m).all(axis=-1)):
            body = bodies[place]
            name = body.placement.name
            distance = _distance(world, body, probe, radius_m) if name not in seen else radius_m
            if distance < radius_m:
                seen.add(name)
                yield Obstruction(
                    mover=mover.name, name=name, time_s=float(time_s), clearance_m=distance
                )


def _distance(world: World, body: Body, probe: int, within_m: float) -> float:
    points = world.client.getClosestPoints(body.bullet_id, probe, within_m, linkIndexA=body.link)
    return float(min((point[8] for point in points), default=within_m))


def _in_a_rug(pair: Sequence[Body]) -> bool:
    """Return whether one is a rug, and neither moves."""
    rug = any(body.placement.asset.category == RUG for body in pair)
    return rug and all(body.placement.static for body in pair)


def _belong_together(a: Body, b: Body) -> bool:
    of_room = all("room" in body.placement.asset.tags for body in (a, b))
    return of_room or _joined(a, b)


def _joined(a: Body, b: Body) -> bool:
    """Return whether one carries the other on a joint: they may stand in one another there."""
    return any(isinstance(x, JointedBody) and x.parent is y for x, y in ((a, b), (b, a)))
