"""The objects of a running world → the entries of a scene file that say what and where they are.

What is as its file has it keeps the words of the file; what was moved or added is written as it is
now.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene.serialisation import PLACE_KEYS, VELOCITY_KEYS, pose_entry, rounded
from sailenv_ros.scene.spec import ObjectSpec
from sailenv_ros.simulation.editing.settled_places import settled_place
from sailenv_ros.types.geometry import Pose, pose_angle_deg
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.world import World

__all__ = ["object_entries"]

Entry = dict[str, Any]

SETTLED_M = 0.002
SETTLED_DEG = 0.5
"""Greatest displacement by settling: an object at rest that physics moved by no more still stands
on its carrier, or at its wall."""

SAME_M = 1e-6
SAME_DEG = 1e-4
"""Greatest displacement up to which an object keeps the text of its file."""

AT_REST = 0.01
"""Slower is at rest [m/s], [rad/s]."""


def object_entries(world: World) -> list[Entry]:
    """Return the entries of all objects, those too that wait, in the order of their ids."""
    begun, waiting = world.first_bodies, world.waiting
    assert world.described is not None
    transient = world.described.transient_objects
    # What is at a wall would come nearer to it without the board at its foot.
    same_walls = not world.room_changed and "skirting" not in world.missing_parts
    entries = {
        id_: _visitor(body.placement, body.entry_pose)
        if body.placement.name in transient
        else _object(
            body, begun, unchanged=_placement_unchanged(body, begun, same_walls=same_walls)
        )
        for id_, body in world.numbered_bodies
        if body.placement.entry is not None and not body.placement.robot
    }
    entries.update({id_: _visitor(waiting[id_], waiting[id_].pose) for id_ in waiting})
    return [entry for _, entry in sorted(entries.items())]


def _visitor(placement: Placement, pose: Pose) -> Entry:
    """Return what comes and goes: as it is when it comes, wherever it is now."""
    assert placement.entry is not None
    entry: Entry = placement.entry.model_dump(
        mode="json", exclude_unset=True, exclude_defaults=True
    )
    carried = placement.entry.on is not None or placement.entry.wall is not None
    if not carried and not _is_same(placement.entry.pose, pose):
        for key in PLACE_KEYS:
            entry.pop(key, None)
        entry.update(pose_entry(pose))
    return entry


def _object(body: Body, begun: Mapping[str, Body], *, unchanged: bool) -> Entry:
    placement = body.placement
    assert placement.entry is not None
    entry: Entry = placement.entry.model_dump(
        mode="json", exclude_unset=True, exclude_defaults=True, exclude={"behaviours"}
    )
    if isinstance(body, JointedBody):
        return {**entry, "joint": _joint(body), **_driven(body, placement.entry)}
    if not unchanged:
        for key in (*PLACE_KEYS, *VELOCITY_KEYS):
            entry.pop(key, None)
        entry.update(pose_entry(body.placed_pose()))
        entry.update(_velocities(body))
    elif placement.entry.wall is None and not _as_put(body, begun):
        on = placement.entry.on
        for key in PLACE_KEYS:
            entry.pop(key, None)
        entry.update(
            pose_entry(body.placed_pose()) if on is None else settled_place(body, begun[on])
        )
    elif "orientation" in entry:
        del entry["orientation"]
        entry.update(pose_entry(placement.entry.pose))
    if placement.static:
        entry = {key: value for key, value in entry.items() if key not in VELOCITY_KEYS}
    return {**entry, **_driven(body, placement.entry)}


def _driven(body: Body, entry: ObjectSpec) -> Entry:
    behaviours = _behaviours(body, entry)
    return {"behaviours": behaviours} if behaviours else {}


def _joint(body: JointedBody) -> Entry:
    """Return an object's joint as its entry has it, with its position and velocity of now."""
    spec = body.joint.spec
    entry: Entry = spec.model_dump(mode="json", exclude_unset=True)
    position, velocity = body.joint_state()
    if position != spec.start:
        entry["position"] = position
    if velocity != spec.velocity:
        entry["velocity"] = velocity
    return entry


def _placement_unchanged(body: Body, begun: Mapping[str, Body], *, same_walls: bool) -> bool:
    """Return whether it stands where its entry puts it, and so does all that carries it."""
    entry = body.placement.entry
    if entry is None or not body.arranged:
        return False
    if entry.wall is not None and not same_walls:
        return False
    if entry.on is not None:
        carrier = begun.get(entry.on)
        if carrier is None or carrier.placement.name != entry.on:
            return False
        if not _placement_unchanged(carrier, begun, same_walls=same_walls):
            return False
    return body.placement.static or _only_settled(body)


def _as_put(body: Body, begun: Mapping[str, Body]) -> bool:
    """Return whether neither it nor what carries it has settled by anything that is written."""
    entry = body.placement.entry
    if entry is not None and entry.on is not None and not _as_put(begun[entry.on], begun):
        return False
    return _is_same(body.entry_pose, body.pose(), SAME_M, SAME_DEG)


def _only_settled(body: Body) -> bool:
    first, now = body.entry_pose, body.pose()
    speeds = np.concatenate(body.velocity())
    at_first = (*body.placement.linear_velocity, *body.placement.angular_velocity)
    if _is_same(first, now) and np.array_equal(speeds, at_first):
        return True
    return (
        math.dist(first.position_m, now.position_m) <= SETTLED_M
        and pose_angle_deg(first, now) <= SETTLED_DEG
        and float(np.abs(speeds).max()) <= AT_REST
    )


def _is_same(first: Pose, second: Pose, within_m: float = 1e-12, within_deg: float = 1e-6) -> bool:
    """Return whether two poses are the same up to rounding, or up to so much [m], [deg]."""
    return math.dist(first.position_m, second.position_m) < within_m and (
        pose_angle_deg(first, second) < within_deg
    )


def _velocities(body: Body) -> Entry:
    """Return how it moves, if it does."""
    if body.placement.static:
        return {}
    linear, angular = body.velocity()
    entry: Entry = {}
    if _is_fast(linear):
        entry["velocity"] = rounded(linear.tolist(), 6)
    if _is_fast(angular):
        entry["angular_velocity"] = rounded(np.degrees(angular).tolist(), 6)
    return entry


def _is_fast(velocity: NDArray[np.float64]) -> bool:
    return float(np.abs(velocity).max()) > AT_REST


def _behaviours(body: Body, entry: ObjectSpec) -> list[Entry]:
    if body.behaviours_unchanged:
        return [b.model_dump(mode="json", exclude_unset=True) for b in entry.behaviours]
    return [
        {
            "type": running.kind.type,
            **running.parameters.model_dump(mode="json", exclude_unset=True),
        }
        for running in body.behaviours
    ]
