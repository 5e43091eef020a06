"""Descriptions of robots → what a world can spawn, and running robots → their descriptions."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sailenv_ros.assets.robots import RobotStore, is_of_package, robot_path
from sailenv_ros.scene.entries import checked_scene
from sailenv_ros.scene.knowledge import SceneKnowledge
from sailenv_ros.scene.serialisation import PLACE_KEYS, pose_entry
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.scene.spec_robots import RobotSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.joint_links import JointDrive
from sailenv_ros.world.robot import Robot
from sailenv_ros.world.robot_motors import GAIN
from sailenv_ros.world.robot_placements import RobotPlacement
from sailenv_ros.world.world import World

__all__ = ["RobotRecord", "robot_entries", "robot_placement", "robot_record", "with_full_paths"]

Entry = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotRecord:
    """A robot as it was at an instant, by which an editor undoes a change.

    Attributes
    ----------
    name : str
    entry : mapping
        What a scene file would say of it, but for its place.
    pose : Pose
        From its parent, if it has one.
    """

    name: str
    entry: Mapping[str, Any]
    pose: Pose


def with_full_paths(scene: SceneSpec, folder: Path) -> SceneSpec:
    """Return a scene whose robots' files are found from wherever it is read again.

    Raises
    ------
    AssetError
        If a file is not there.
    """
    if not scene.robots:
        return scene
    robots = tuple(_with_full_path(one, folder) for one in scene.robots)
    return scene.model_copy(update={"robots": robots})


def _with_full_path(spec: RobotSpec, folder: Path) -> RobotSpec:
    if is_of_package(spec.file):
        return spec
    return spec.model_copy(update={"file": str(robot_path(spec.file, folder))})


def robot_placement(
    entry: Mapping[str, Any],
    pose: Pose,
    taken: Iterable[str],
    store: RobotStore,
    knowledge: SceneKnowledge,
) -> RobotPlacement:
    """Check a robot's description and make of it what a world can spawn.

    Parameters
    ----------
    entry : mapping
        With the keys of a robot in a scene file, but for those of its place; one without a name is
        given one that is not among `taken`.
    pose : Pose
        From its parent, if it has one.

    Raises
    ------
    InvalidEntry, AssetError
        If it cannot be read.
    """
    file = str(entry.get("file", ""))
    named = {"name": _free_name(file, set(taken)), **entry}
    parent = named.pop("parent", None)
    data = {"version": 1, "robots": [named]}
    checked = checked_scene(data, knowledge, what=f"robot {named['name']!r}").robots[0]
    spec = _with_full_path(checked, Path())
    place: Entry = {"position": pose.position_m, "orientation": pose.orientation_xyzw}
    spec = spec.model_copy(update={**place, **({"parent": str(parent)} if parent else {})})
    return RobotPlacement(spec=spec, model=store.find(spec.file))


def robot_entries(world: World) -> list[Entry]:
    """Return the entries of all robots as they stand now."""
    return [_entry(robot) for robot in world.robots]


def robot_record(robot: Robot) -> RobotRecord:
    """Take down a robot as it stands now."""
    entry = {key: value for key, value in _entry(robot).items() if key not in PLACE_KEYS}
    fixed = robot.placement.mount == "fixed"
    pose = robot.placement.spec.pose if fixed else robot.first_pose()
    return RobotRecord(name=robot.name, entry=entry, pose=pose)


def _entry(robot: Robot) -> Entry:
    spec = robot.placement.spec
    entry: Entry = spec.model_dump(mode="json", exclude_unset=True)
    if robot.placement.mount != "fixed":
        for key in PLACE_KEYS:
            entry.pop(key, None)
        entry.update(pose_entry(robot.first_pose()))
    elif "orientation" in entry:
        del entry["orientation"]
        entry.update(pose_entry(spec.pose))
    joints = _joint_entries(robot)
    entry.pop("joints", None)
    return {**entry, **({"joints": joints} if joints else {})}


def _joint_entries(robot: Robot) -> list[Entry]:
    """Return what a scene file says of the joints as they are now."""
    entries = []
    for joint in (link.joint for link in robot.model.moving):
        entry: Entry = {"name": joint.name}
        position = robot.positions()[joint.name]
        if position:
            entry["position"] = position
        drive = robot.drives.get(joint.name)
        if drive is not None and joint.mimic is None:
            default = JointDrive(
                mode="position", target=position, gain=GAIN, effort=joint.effort, speed=joint.speed
            )
            told = dataclasses.asdict(drive)
            entry |= {key: told[key] for key in told if told[key] != getattr(default, key)}
        if len(entry) > 1:
            entries.append(entry)
    return entries


def _free_name(file: str, taken: set[str]) -> str:
    stem = re.split(r"[/\\:]", file)[-1].rsplit(".", 1)[0]
    plain = re.sub(r"[^a-z0-9_]+", "_", stem.lower()).strip("_")[:20] or "robot"
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain}_{number}", number + 1
    return name
