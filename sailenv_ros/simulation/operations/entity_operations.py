"""Operations behind ROS's `simulation_interfaces`; a program has those of `operations`.

All that is told of several entities is of one instant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from sailenv_ros.assets.robots import is_of_package, keep_description, robot_path
from sailenv_ros.authoring.viewpoints import sample_cameras
from sailenv_ros.errors import SailenvError
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasEditor, HasLibrary, HasWorld, ViewsScene
from sailenv_ros.simulation.present_entities import Box, box_of, entities_of, robot_of
from sailenv_ros.simulation.space_queries import solids_of_world
from sailenv_ros.space.outlines import Solid
from sailenv_ros.space.solid_distances import collision_box, solid_distance_m
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.entities import AssetOutline, Entity, NamedPose
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import vector

__all__ = ["EntityOperations"]

Vector3 = tuple[float, float, float]

NOT_MOVING = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

VIEWPOINTS = 8
"""Viewpoints of a scene that have a name."""


class EntityOperations(Caller):
    """Operations behind ROS's `simulation_interfaces`."""

    @operation()
    @staticmethod
    def entities(core: HasWorld, region: Solid | None = None) -> tuple[Entity, ...]:
        """Return every object and robot, or those that a region touches; see `entities_of`.

        Parameters
        ----------
        region : Solid or None
            In the world; collision shapes count, or the drawn box of what has none.
        """
        return entities_of(core.world, region)

    @operation()
    @staticmethod
    def entity_box(core: HasWorld, entity: int) -> Box:
        """Return the box around an entity's collision shapes in its own frame [m].

        Around what is drawn, where it has no collision shapes.
        """
        return box_of(core.world, entity)

    @operation()
    @staticmethod
    def remove_entity(core: HasEditor, entity: int) -> None:
        """Remove an object, or a robot with all its links.

        Raises
        ------
        InvalidRequest, InvalidState
            If it is a link, carries something on a joint, or lessons name it.
        """
        if entity < 0:
            core.world.despawn_robot(robot_of(core.world, entity).name)
        else:
            core.editor.require_untaught(entity)
            core.world.despawn(entity)
        core.announce()

    @operation(pose=check.pose)
    @staticmethod
    def spawn_entry(core: HasEditor, entry: Mapping[str, Any], pose: Pose) -> int:
        """Add an object with the keys of a scene file, but for its place; return its id.

        It is static where nothing else is said and nothing collides with it, as it would fall
        through the floor.
        """
        asset = core.library.peek_asset(str(entry.get("asset", "")))
        still = {} if asset.collision else {"static": True}
        return core.editor.spawn({**still, **entry}, pose)

    @operation(file=check.text)
    @staticmethod
    def robot_file(core: HasLibrary, file: str) -> str:
        """Return a path of a robot's file, or ``PACKAGE:path``, which is there.

        Raises
        ------
        AssetMissing
            If it is not.
        """
        return file if is_of_package(file) and robot_path(file) else str(robot_path(file))

    @operation(deadline_s=120.0, file=check.text)
    @staticmethod
    def robot_name(core: HasLibrary, file: str) -> str:
        """Return the name that a robot has in its file.

        Raises
        ------
        AssetError
            If it cannot be read.
        """
        return core.library.robots.find(file).name

    @operation(deadline_s=120.0, text=check.text)
    @staticmethod
    def sent_robot(core: HasLibrary, text: str) -> str:
        """Keep the text of a URDF or MJCF file; return the path of the file that it is then.

        Raises
        ------
        AssetError
            If it cannot be read; it is not kept then.
        """
        path = keep_description(text)
        try:
            core.library.robots.read(path)
        except BaseException:
            path.unlink(missing_ok=True)
            raise
        return str(path)

    @operation(deadline_s=120.0, pose=check.pose)
    @staticmethod
    def spawn_robot_entry(core: HasEditor, entry: Mapping[str, Any], pose: Pose) -> int:
        """Add a robot with the keys of a scene file, but for its place; return its entity's id."""
        name = core.editor.spawn_robot(entry, pose)
        return -next(iter(core.world.robot_state(name).links.values()))

    @operation(pose=check.optional(check.pose))
    @staticmethod
    def set_entity(
        core: HasWorld,
        entity: int,
        pose: Pose | None,
        velocities: tuple[Vector3, Vector3] | None,
    ) -> None:
        """Put an object or robot somewhere at once, and let it move on at a velocity.

        Parameters
        ----------
        entity : int
        pose : Pose or None
            None leaves it where it is.
        velocities : tuple of two (3,) tuples of float, or None
            Of its own frame's origin [m/s], and angular [rad/s], world axes; None leaves them, but
            stops what is put elsewhere.

        Raises
        ------
        UnknownName, InvalidRequest
            If one of them cannot be; nothing is changed then.
        """
        world, number = core.world, abs(entity)
        if velocities == NOT_MOVING and world.body(number).placement.static:
            velocities = None
        if velocities is not None:
            # Refused before anything is moved; it is said again once it stands there.
            world.set_velocity(number, *velocities)
        if pose is not None:
            world.put_body(number, pose, teleport=True)
            if velocities is not None:
                world.set_velocity(number, *velocities)

    @operation()
    @staticmethod
    def put_entities_back(core: HasWorld) -> None:
        """Put what was there at the start where it was then, and as it moved; time stays."""
        core.world.put_back()

    @operation()
    @staticmethod
    def remove_added(core: HasEditor) -> None:
        """Remove every object and robot that was spawned since the scene began.

        Raises
        ------
        InvalidState
            If lessons name one of them; nothing is removed then.
        """
        world = core.world
        for number in world.added_ids:
            core.editor.require_untaught(number)
        for robot in world.robots.added:
            world.despawn_robot(robot)
        for number in reversed(world.added_ids):  # what hangs on another came after it
            world.despawn(number)
        core.announce()

    @operation(deadline_s=120.0)
    @staticmethod
    def named_poses(core: ViewsScene) -> tuple[NamedPose, ...]:
        """Return the waypoints of the movers, and viewpoints that the scene's seed chooses."""
        found = [
            NamedPose(
                name=f"{mover.name}/waypoint_{place}",
                description=f"waypoint {place} of the mover {mover.name}",
                tags=("waypoint", mover.name),
                pose=pose,
            )
            for mover in core.world.movers.values()
            for place, pose in enumerate(mover.waypoints, 1)
        ]
        try:
            views = sample_cameras(
                core.view_scene(CameraIntrinsics()),
                "free_view",
                VIEWPOINTS,
                seed=core.seed,
                name="named_poses",
            )
        except SailenvError:
            views = []  # nothing is free there, or nothing to be seen
        return (
            *found,
            *(
                NamedPose(
                    name=f"viewpoint_{place}",
                    description="a camera in free space that sees objects",
                    tags=("viewpoint",),
                    pose=view.pose,
                )
                for place, view in enumerate(views, 1)
            ),
        )

    @operation()
    @staticmethod
    def clearance_m(core: HasWorld, point_m: Vector3) -> float:
        """Return the distance from a point to the nearest collision shape now [m].

        Infinite where there is none.
        """
        place = Solid(np.array([point_m]))
        solids = solids_of_world(core.world)
        return min((solid_distance_m(place, one) for one in solids), default=float("inf"))

    @operation()
    @staticmethod
    def asset_outlines(core: HasLibrary, names: Iterable[str]) -> tuple[AssetOutline, ...]:
        """Return how much room assets take up, in the order of the names."""
        found = []
        for name in names:
            asset = core.library.peek_asset(name)
            box = collision_box(asset.collision, (1.0, 1.0, 1.0)) or asset.model.bounds()
            found.append(
                AssetOutline(
                    name=name,
                    display_name=asset.display_name,
                    category=asset.category,
                    box_m=(vector("low", box[0]), vector("high", box[1])),
                )
            )
        return tuple(found)

    @operation(scene=check.text)
    @staticmethod
    def scene_words(core: HasLibrary, scene: str) -> tuple[str, tuple[str, ...]]:
        """Return what people call a scene, and tags of what is in it.

        Raises
        ------
        UnknownName, SceneError
            If there is none, or its file has errors.
        """
        spec = core.library.load(scene)
        tags = ["room" if spec.room is not None else "open"]
        tags += ["lessons"] if spec.lessons else []
        return spec.title or spec.name, tuple(tags)
