"""Objects brought to where chance has drawn them, as a scene begins.

Drawn keys in, a changed world out; what stands on something goes along with it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sailenv_ros.assets.arranging import arranged
from sailenv_ros.scene.randomise.randomisation import Values
from sailenv_ros.scene.serialisation import PLACE_KEYS
from sailenv_ros.scene.spec import ObjectSpec, SceneSpec
from sailenv_ros.simulation.editing.editor import SceneEditor
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.simulation.script.floor_places import placed_on_floor
from sailenv_ros.space.free_space import BodySize, FreeSpace
from sailenv_ros.types.geometry import Pose

__all__ = ["add_drawn", "arrange_drawn", "move_drawn"]


def arrange_drawn(
    editor: SceneEditor, spec: SceneSpec, drawn: Mapping[str, Mapping[str, Any]]
) -> None:
    """Bring objects to where a file would put them that says what was drawn.

    Parameters
    ----------
    editor : SceneEditor
        Of a scene that has just begun.
    spec : SceneSpec
        Its description.
    drawn : mapping
        Keys that were drawn, by the names of the objects.
    """
    scene = editor.scene
    world, library = scene.world, scene.library
    absent = {name for name, keys in drawn.items() if keys.get("there") is False}
    entries: list[ObjectSpec] = []
    for entry in _carriers_first(spec.objects):
        if entry.name in absent or entry.on in absent:
            absent.add(entry.name)
            continue
        entries.append(_with_drawn(entry, drawn.get(entry.name, {})))
    stock = {entry.name: library.peek_asset(entry.asset) for entry in entries}
    poses = {name: pose.matrix() for name, pose in arranged(entries, stock, spec.room).items()}
    for entry in entries:
        keys = drawn.get(entry.name, {})
        if "offset" in keys or "turn" in keys:
            _carry(poses, entries, entry.name, keys)
    begun = {entry.name: entry for entry in spec.objects}
    waiting = dict(world.waiting.names())
    for name in absent:
        world.despawn(waiting.pop(name, 0) or world.find(name))
    for entry in entries:
        pose = Pose.from_matrix(poses[entry.name])
        if entry.name in waiting:
            _arrange_waiting(scene, waiting[entry.name], entry, begun[entry.name], pose)
            continue
        number = world.find(entry.name)
        if entry.asset != begun[entry.name].asset:
            world.despawn(number)
            keys = entry.model_dump(exclude_unset=True, exclude={*PLACE_KEYS})
            world.spawn(library.placement(keys, pose, world, seed=scene.seed, start_s=0.0))
            continue
        if entry.scale != begun[entry.name].scale:
            editor.change_object(number, {"scale": entry.scale})
        if not np.allclose(pose.matrix(), world.body(number).entry_pose.matrix(), atol=1e-12):
            world.put_body(number, pose, teleport=True)


def add_drawn(
    editor: SceneEditor, values: Values, free_space: Callable[[BodySize], FreeSpace]
) -> Values:
    """Add the objects that were drawn, each where the floor is free beside those before it.

    Returns
    -------
    values : mapping
        With the places that were found; ``left_out`` names objects for which there was none.
    """
    if not values.get("added"):
        return values
    added, left_out = [], []
    for drawn in values["added"]:
        entry = placed_on_floor(drawn, editor.scene.library.peek_asset(drawn["asset"]), free_space)
        if entry is None:
            left_out.append(drawn["name"])
            continue
        added.append(entry)
        keys = {key: value for key, value in entry.items() if key not in PLACE_KEYS}
        editor.spawn(keys, _pose_of(entry))
    return {**values, "added": added, **({"left_out": left_out} if left_out else {})}


def move_drawn(editor: SceneEditor, number: int, behaviours: Sequence[Mapping[str, Any]]) -> None:
    """Let an object move by behaviours that were drawn; one that was static moves from now on."""
    if not behaviours:
        return
    if editor.scene.world.body(number).placement.static:
        editor.change_object(number, {"static": False})
    for behaviour in behaviours:
        editor.add_behaviour(number, behaviour)


def _pose_of(entry: Mapping[str, Any]) -> Pose:
    position = tuple(entry["position"])
    if "orientation" in entry:
        return Pose(position, tuple(entry["orientation"]))
    return Pose.from_rpy_deg(position, tuple(entry["rotation"]))


def _arrange_waiting(
    scene: LiveScene, number: int, entry: ObjectSpec, begun: ObjectSpec, pose: Pose
) -> None:
    """Let an object that waits enter as it was drawn."""
    world = scene.world
    placement = world.waiting[number]
    if entry.asset != begun.asset or entry.scale != begun.scale:
        keys = entry.model_dump(exclude_unset=True, exclude={*PLACE_KEYS, "appear", "leave"})
        keys["scale"] = entry.scale
        drawn = scene.library.placement(keys, pose, world, seed=scene.seed, start_s=0.0)
        placement = replace(drawn, entry=entry)
    elif np.allclose(pose.matrix(), placement.pose.matrix(), atol=1e-12):
        return
    world.wait_as(number, replace(placement, pose=pose))


def _with_drawn(entry: ObjectSpec, keys: Mapping[str, Any]) -> ObjectSpec:
    update: dict[str, Any] = {"asset": keys["asset"]} if "asset" in keys else {}
    if "scale" in keys:
        scale = keys["scale"]  # one factor for all axes, or one for each
        update["scale"] = tuple(scale) if isinstance(scale, list | tuple) else (float(scale),) * 3
    return entry.model_copy(update=update) if update else entry


def _carriers_first(entries: Sequence[ObjectSpec]) -> list[ObjectSpec]:
    """Return the entries so that none comes before what carries it."""
    by_name = {entry.name: entry for entry in entries}

    def depth(entry: ObjectSpec) -> int:
        above = 0
        while entry.on is not None and entry.on in by_name and above < len(by_name):
            entry, above = by_name[entry.on], above + 1
        return above

    return sorted(entries, key=depth)


def _carry(
    poses: dict[str, Any], entries: Sequence[ObjectSpec], name: str, keys: Mapping[str, Any]
) -> None:
    """Shift and turn an object about its origin, and what stands on it."""
    origin = poses[name][:3, 3].copy()
    motion = Pose.from_rpy_deg((0.0, 0.0, 0.0), (0.0, 0.0, float(keys.get("turn", 0.0)))).matrix()
    motion[:3, 3] = origin - motion[:3, :3] @ origin + np.asarray(keys.get("offset", (0, 0, 0)))
    moving = {name}
    for entry in entries:  # carriers come first
        if entry.on in moving:
            moving.add(entry.name)
    for one in moving:
        poses[one] = motion @ poses[one]
