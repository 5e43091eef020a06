"""Operations behind ROS's `simulation_interfaces`; a program has those of `operations`.

All that is told of several entities is of one instant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.authoring.viewpoints import sample_cameras
from sailenv_ros.errors import SailenvError
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasEditor, HasLibrary, HasWorld, ViewsScene
from sailenv_ros.simulation.space_queries import solids_of_body, solids_of_world
from sailenv_ros.space.outlines import Solid
from sailenv_ros.space.solid_distances import collision_box, solid_distance_m, solids_overlap
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.entities import AssetOutline, Entity, NamedPose
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import vector
from sailenv_ros.world.bodies import Body

__all__ = ["EntityOperations"]

Vector3 = tuple[float, float, float]
Box = tuple[Vector3, Vector3]

NOT_MOVING = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

VIEWPOINTS = 8
"""Viewpoints of a scene that have a name."""


class EntityOperations(Caller):
    """Operations behind ROS's `simulation_interfaces`."""

    @operation()
    @staticmethod
    def entities(core: HasWorld, region: Solid | None = None) -> tuple[Entity, ...]:
        """Return every object, in the order of the ids; or those that a region touches.

        Parameters
        ----------
        region : Solid or None
            In the world; collision shapes count, or the drawn box of what has none.
        """
        world = core.world
        added, moving, states = set(world.added_ids), world.moving_ids, world.states()
        rows = {int(number): row for row, number in enumerate(states.ids)}
        accelerations = world.accelerations()
        found = []
        for drawn in world.contents.instances:
            one = drawn.instance
            if one.is_part:
                continue
            body = world.body(one.id)
            if region is not None and not _touches(body, one.low_m, one.high_m, region):
                continue
            row = rows[one.id]
            found.append(
                Entity(
                    id=one.id,
                    name=one.name,
                    asset=one.asset,
                    category=one.category,
                    static=one.static,
                    moving=one.id in moving,
                    added=one.id in added,
                    pose=body.pose(),
                    linear_velocity=vector("velocity", states.linear_velocities[row]),
                    angular_velocity=vector("velocity", states.angular_velocities[row]),
                    linear_acceleration=accelerations[one.id][0],
                    angular_acceleration=accelerations[one.id][1],
                    sim_time_ns=world.sim_time_ns,
                )
            )
        return tuple(found)

    @operation(obj=check.object_reference)
    @staticmethod
    def entity_box(core: HasWorld, obj: int | str) -> Box:
        """Return the box around an object's collision shapes in its own frame [m].

        Around what is drawn, where it has no collision shapes.
        """
        number = core.world.find(obj)
        placement = core.world.body(number).placement
        box = collision_box(placement.asset.collision, placement.scale)
        if box is None:
            instances = (drawn.instance for drawn in core.world.contents.instances)
            one = next(one for one in instances if one.id == number)
            return one.low_m, one.high_m
        return vector("low", box[0]), vector("high", box[1])

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

    @operation(obj=check.object_reference, pose=check.optional(check.pose))
    @staticmethod
    def set_entity(
        core: HasWorld,
        obj: int | str,
        pose: Pose | None,
        velocities: tuple[Vector3, Vector3] | None,
    ) -> None:
        """Put an object somewhere at once, and let it move on at a velocity.

        Parameters
        ----------
        obj : int or str
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
        world = core.world
        number = world.find(obj)
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
        """Remove every object that was spawned since the scene began.

        Raises
        ------
        InvalidState
            If lessons name one of them; nothing is removed then.
        """
        for number in core.world.added_ids:
            core.editor.require_untaught(number)
        for number in reversed(core.world.added_ids):  # what hangs on another came after it
            core.world.despawn(number)
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


def _touches(body: Body, low_m: Vector3, high_m: Vector3, region: Solid) -> bool:
    if body.collides:
        return any(solids_overlap(solid, region) for solid in solids_of_body(body))
    matrix = body.world_from_body()
    corners: NDArray[np.float64] = np.array(
        [(x, y, z) for x in (low_m[0], high_m[0]) for y in (low_m[1], high_m[1])
         for z in (low_m[2], high_m[2])]
    )  # fmt: skip
    return solids_overlap(Solid(corners @ matrix[:3, :3].T + matrix[:3, 3]), region)
