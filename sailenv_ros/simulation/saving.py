"""A running world → what a scene file says of it, as plain data.

What is as its file has it keeps the words of the file: a room, what stands at a wall or upon
something, a track. What was changed, moved or added is written as it is now. Writes no file.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.geometry import Pose, pose_angle_deg
from sailenv_ros.scene.serialisation import (
    PLACE_KEYS,
    VELOCITY_KEYS,
    agent_entry,
    body_entry,
    changed_light_entry,
    light_entry,
    look_at_entry,
    pose_entry,
    rounded,
)
from sailenv_ros.scene.spec import (
    AgentSpecModel,
    EnvironmentSpec,
    MoverSpec,
    ObjectSpec,
    SceneSpec,
)
from sailenv_ros.simulation.agent_table import AgentRecord, AgentTable
from sailenv_ros.simulation.settled_places import settled_place
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.world import World

__all__ = ["described_world", "environment_entry", "room_entry", "unsaid", "uploaded_models"]

Entry = dict[str, Any]

SETTLED_M = 0.002
SETTLED_DEG = 0.5
"""What physics has moved by no more, and is at rest, has only settled: it still stands upon its
carrier, or at its wall."""

SAME_M = 1e-6
SAME_DEG = 1e-4
"""What has moved by no more keeps the words of its file."""

AT_REST = 0.01
"""Slower is at rest [m/s], [rad/s]."""

_MAY_BE_LEFT_OUT = ("ceiling", "skirting", "curtains")
"""Parts of a room without which a file can describe it."""

_SKY_COLOURS = ("sky_zenith", "sky_horizon", "sky_ground")


def described_world(world: World, agents: AgentTable, *, cameras: Collection[str] = ()) -> Entry:
    """Return the data of a scene file that this world can be built from.

    Parameters
    ----------
    world : World
        One that was built from a scene.
    agents : AgentTable
        Those that the scene brought along are saved as they are now.
    cameras : collection of str
        Names of further agents to be saved.
    """
    spec = world.described
    assert spec is not None
    data: Entry = spec.model_dump(mode="json", exclude_unset=True, exclude={"name", "randomise"})
    if world.gravity != spec.gravity:
        data["gravity"] = world.gravity
    if any(not body.placement.static for body in world.bodies):
        data["settled"] = False
    changed: dict[str, Any] = {
        "environment": environment_entry(world),
        "lights": _lights(world, spec),
        "room": room_entry(world),
        "objects": _objects(world),
        **_movers(world, spec),
        "agents": _agents(world, spec, agents, cameras),
    }
    data.update(changed)
    empty = [key for key in changed if not data[key]]
    for key in empty:
        del data[key]
    return {key: data[key] for key in SceneSpec.model_fields if key in data}


def unsaid(world: World) -> Iterator[tuple[str, str]]:
    """Yield what a scene file cannot say of a world: what it is about, and why."""
    for name in sorted(world.missing_parts):
        if not name.startswith(_MAY_BE_LEFT_OUT):
            yield repr(name), "is a part of the room and was taken out, which no scene file can say"
    for body in world.bodies:
        if body.placement.entry is None and not body.arranged:
            name = body.placement.name
            yield repr(name), "is a part of the room and was moved, which no scene file can say"


def uploaded_models(world: World, is_uploaded: Callable[[str], bool]) -> tuple[str, ...]:
    """Return the catalogue names of the models in a world that this simulator alone has.

    Parameters
    ----------
    is_uploaded : callable
        Says of a catalogue name if it is such a model's.
    """
    names = {body.placement.asset.name for body in world.bodies if body.placement.entry}
    return tuple(sorted(name for name in names if is_uploaded(name)))


# -- surroundings --------------------------------------------------------------------------


def environment_entry(world: World) -> Entry:
    """Return the surroundings; colours of the sky are the file's, a photographed sky keeps its."""
    assert world.described is not None
    described = world.described.environment
    now = world.contents.environment
    changes = {
        key: getattr(now, key)
        for key in EnvironmentSpec.model_fields
        if key not in _SKY_COLOURS and getattr(now, key) != getattr(described, key)
    }
    entry: Entry = described.model_copy(update=changes).model_dump(mode="json", exclude_unset=True)
    return entry


def room_entry(world: World) -> Entry:
    """Return the room without those parts that were taken out of it; empty if there is none."""
    assert world.described is not None
    room, missing = world.described.room, world.missing_parts
    if room is None:
        return {}
    entry: Entry = room.model_dump(mode="json", exclude_unset=True)
    entry.update({key: False for key in ("ceiling", "skirting") if key in missing})
    windows = [opening for opening in entry.get("openings", ()) if opening["type"] == "window"]
    for number, window in enumerate(windows, start=1):
        if f"curtains {number}" in missing:
            window["curtains"] = False
    _note_doors(entry, world)
    return entry


def _note_doors(entry: Entry, world: World) -> None:
    """Write how far the doors of a room are open now."""
    leaves = {b.placement.name: b for b in world.bodies if isinstance(b, JointedBody)}
    doors = [opening for opening in entry.get("openings", ()) if opening["type"] == "door"]
    named = {f"door {number} leaf": door for number, door in enumerate(doors, start=1)}
    for wall in entry.get("partitions", ()):
        for number, doorway in enumerate(wall.get("doorways", ()), start=1):
            named[f"{wall['name']} door {number} leaf"] = doorway
    for name, door in named.items():
        leaf = leaves.get(name)
        if leaf is not None and leaf.placement.entry is None:
            position, _ = leaf.joint_state()
            if position != leaf.joint.spec.start:
                door["open"] = math.degrees(position)


def _lights(world: World, spec: SceneSpec) -> list[Entry]:
    described = {light.name: light for light in spec.lights}
    return [
        changed_light_entry(described[light.name], light)
        if light.name in described
        else light_entry(light)
        for light in world.contents.lights
    ]


# -- objects -------------------------------------------------------------------------------


def _objects(world: World) -> list[Entry]:
    begun, waiting = world.first_bodies, world.waiting
    assert world.described is not None
    visitors = world.described.visitors
    # What is at a wall would come nearer to it without the board at its foot.
    same_walls = not world.room_changed and "skirting" not in world.missing_parts
    entries = {
        id_: _visitor(body.placement, body.entry_pose)
        if body.placement.name in visitors
        else _object(
            body, begun, unchanged=_placement_unchanged(body, begun, same_walls=same_walls)
        )
        for id_, body in world.numbered_bodies
        if body.placement.entry is not None
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
        entry.update(pose_entry(body.pose()))
        entry.update(_velocities(body))
    elif placement.entry.wall is None and not _as_put(body, begun):
        on = placement.entry.on
        for key in PLACE_KEYS:
            entry.pop(key, None)
        entry.update(pose_entry(body.pose()) if on is None else settled_place(body, begun[on]))
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


# -- movers and agents ---------------------------------------------------------------------


def _movers(world: World, spec: SceneSpec) -> Entry:
    """Return `mover` or `movers`, as the file has it; nothing if none is there or changed."""
    entries = [
        _mover(world.movers[described.name], described, world.sim_time_ns)
        for described in spec.all_movers
    ]
    if spec.movers:
        return {"movers": entries}
    return {"mover": entries[0]}


def _mover(mover: Mover, described: MoverSpec, time_ns: int) -> Entry:
    entry: Entry = described.model_dump(mode="json", exclude_unset=True)
    poses = mover.waypoints
    if poses != described.waypoint_poses:
        entry.pop("waypoints", None)
        entries = {
            w.pose: w.model_dump(mode="json", exclude_unset=True) for w in described.waypoints
        }
        if poses:
            entry["waypoints"] = [entries.get(pose) or pose_entry(pose) for pose in poses]
    now = {
        "total_time": mover.total_time_s,
        "loop": mover.loop,
        "controller": mover.controller,
    }
    for key, value in now.items():
        if value != getattr(described, key):
            entry[key] = value
    begun = described.keep_looking_at
    if mover.look_at != (begun and begun.to_look_at()):
        entry.pop("keep_looking_at", None)
        if mover.look_at is not None:
            entry["keep_looking_at"] = look_at_entry(mover.look_at)
    entry.update(_body(entry.pop("body", None), mover, described))
    is_led = mover.controller == "waypoint" and bool(poses)
    pose = mover.own_pose_at(time_ns)
    if not is_led and (pose != described.pose or poses != described.waypoint_poses):
        for key in PLACE_KEYS:
            entry.pop(key, None)
        entry.update(pose_entry(pose))
    return entry


def _body(entry: Entry | None, mover: Mover, described: MoverSpec) -> Entry:
    """Return the body of a mover as its file has it, or as it is now; nothing if it is none."""
    if mover.body is None:
        return {}
    rigid, (linear, angular) = mover.body.rigid, mover.body.motion
    begun = described.body
    at_first = begun and (begun.to_rigid_body(), begun.velocity, begun.angular_velocity_rad_s)
    if at_first == (rigid, linear, angular):
        return {"body": entry}
    return {"body": body_entry(rigid, linear, angular)}


def _agents(
    world: World, spec: SceneSpec, agents: AgentTable, cameras: Collection[str]
) -> list[Entry]:
    described = {agent.name: agent for agent in spec.agents}
    missing = [name for name in cameras if name not in described]
    for name in missing:
        agents[name]  # which must exist
    wanted = (*described, *missing)
    records = {record.spec.name: record for record in agents}
    return [_agent(records[name], described.get(name), world) for name in wanted if name in records]


def _agent(record: AgentRecord, described: AgentSpecModel | None, world: World) -> Entry:
    spec = replace(record.spec, look_at=record.look_at)
    first = world.mover("").name
    if described is not None:
        begun = described.to_agent_spec()
        same = replace(spec, pose=begun.pose) == replace(begun, mover=begun.mover or first)
        if same and (spec.following or begun.pose == record.pose):
            return described.model_dump(mode="json", exclude_unset=True)
    named = replace(spec, mover="" if spec.mover == first else spec.mover)
    return agent_entry(named, None if spec.following else record.pose)
