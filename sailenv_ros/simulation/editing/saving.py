"""A running world → what a scene file says of it, as plain data.

What is as its file has it keeps the words of the file: a room, what stands at a wall or upon
something, a track. What was changed, moved or added is written as it is now. Writes no file.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from typing import Any

from sailenv_ros.scene.serialisation import (
    PLACE_KEYS,
    agent_entry,
    body_entry,
    changed_light_entry,
    light_entry,
    look_at_entry,
    pose_entry,
)
from sailenv_ros.scene.spec import (
    AgentSpecModel,
    EnvironmentSpec,
    MoverSpec,
    SceneSpec,
)
from sailenv_ros.simulation.agent_record import AgentRecord
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.simulation.editing.saved_objects import object_entries
from sailenv_ros.simulation.robot_entries import robot_entries
from sailenv_ros.simulation.room_exposure import is_metered
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.rigs import body_of
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.world import World

__all__ = [
    "described_world",
    "environment_entry",
    "room_entry",
    "unserialisable_changes",
    "uploaded_models",
]

Entry = dict[str, Any]

_MAY_BE_LEFT_OUT = ("ceiling", "skirting", "curtains", "outside")
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
        "objects": object_entries(world),
        "robots": robot_entries(world),
        **_movers(world, spec),
        "agents": _agents(world, spec, agents, cameras),
    }
    data.update(changed)
    empty = [key for key in changed if not data[key]]
    for key in empty:
        del data[key]
    return {key: data[key] for key in SceneSpec.model_fields if key in data}


def unserialisable_changes(world: World) -> Iterator[tuple[str, str]]:
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
    kept = {*_SKY_COLOURS, "meter_exposure", *(("exposure",) if is_metered(world) else ())}
    changes = {
        key: getattr(now, key)
        for key in EnvironmentSpec.model_fields
        if key not in kept and getattr(now, key) != getattr(described, key)
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
    entry.update({key: False for key in ("ceiling", "skirting", "outside") if key in missing})
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
    for name in cameras:
        agents[name]  # which must exist
    # A camera of a rig is kept with its agent.
    kept = dict.fromkeys(body_of(name) or name for name in cameras)
    missing = [name for name in kept if name not in described]
    wanted = (*described, *missing)
    records = {record.spec.name: record for record in agents}
    return [
        _agent(records[name], agents.with_cameras(records[name]), described.get(name), world)
        for name in wanted
        if name in records
    ]


def _agent(
    record: AgentRecord, spec: AgentSpec, described: AgentSpecModel | None, world: World
) -> Entry:
    first = world.mover("").name
    if described is not None:
        begun = described.to_agent_spec()
        mover = begun.mover or ("" if begun.carrier else first)
        same = replace(spec, pose=begun.pose) == replace(begun, mover=mover)
        if same and spec.carrier and begun.pose == spec.pose:
            return described.model_dump(mode="json", exclude_unset=True)
        if same and (spec.following or begun.pose == record.pose):
            return described.model_dump(mode="json", exclude_unset=True)
    named = replace(spec, mover="" if spec.mover == first else spec.mover)
    if spec.carrier:
        return agent_entry(replace(named, mover=""), spec.pose)
    return agent_entry(named, None if spec.following else record.pose)
