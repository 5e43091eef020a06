"""Objects and robots of a world as entities of ROS's `simulation_interfaces`, at one instant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.space.outlines import Solid
from sailenv_ros.space.solid_distances import collision_box, solids_overlap
from sailenv_ros.types.entities import Entity
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.labels import Instance
from sailenv_ros.types.validation import vector
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.crowd import solids_of_body
from sailenv_ros.world.robot import Robot
from sailenv_ros.world.world import World

__all__ = ["Box", "box_of", "entities_of", "robot_of"]

Vector3 = tuple[float, float, float]
Box = tuple[Vector3, Vector3]


def entities_of(world: World, region: Solid | None = None) -> tuple[Entity, ...]:
    """Return every object, in the order of the ids, and each robot before its first link.

    Parameters
    ----------
    world : World
    region : Solid or None
        In the world; those that it touches. Collision shapes count, or the drawn box of what has
        none.
    """
    added, moving, states = set(world.added_ids), world.moving_ids, world.states()
    rows = {int(number): row for row, number in enumerate(states.ids)}
    accelerations = world.accelerations()
    instances = {drawn.instance.id: drawn.instance for drawn in world.contents.instances}
    touched = {
        number
        for number, one in instances.items()
        if region is None or (not one.is_part and _touches(world.body(number), one, region))
    }
    robots = {links[0]: (robot, links) for robot, links in _links(world)}
    found = []

    def entity(number: int, one: Instance, robot: Robot | None) -> Entity:
        row = rows[one.id]
        return Entity(
            id=number,
            name=one.name if robot is None else robot.name,
            asset=one.asset if robot is None else robot.model.name,
            category=one.category,
            static=one.static,
            moving=one.id in moving,
            added=one.id in added,
            pose=world.body(one.id).pose(),
            linear_velocity=vector("velocity", states.linear_velocities[row]),
            angular_velocity=vector("velocity", states.angular_velocities[row]),
            linear_acceleration=accelerations[one.id][0],
            angular_acceleration=accelerations[one.id][1],
            sim_time_ns=world.sim_time_ns,
        )

    for number, one in instances.items():
        if one.is_part:
            continue
        robot, links = robots.get(number, (None, ()))
        if robot is not None and touched.intersection(links):
            found.append(entity(-number, one, robot))
        if number in touched:
            found.append(entity(number, one, None))
    return tuple(found)


def robot_of(world: World, number: int) -> Robot:
    """Return the robot whose first link has an id, which counts below 0.

    Raises
    ------
    InvalidRequest
        If there is none now.
    """
    for robot, links in _links(world):
        if links[0] == -number:
            return robot
    raise InvalidRequest("entity", number, "that of a robot, but there is none of this id")


def box_of(world: World, number: int) -> Box:
    """Return the box around the collision shapes of an object or robot in its own frame [m].

    Around what is drawn, where it has no collision shapes.
    """
    if number >= 0:
        return _box_of_object(world, number)
    links = list(robot_of(world, number).bodies.values())
    first = invert(links[0].world_from_body())
    ids = {body: number for number, body in world.numbered_bodies}
    boxes = [
        _corners(*_box_of_object(world, ids[body])) @ turn[:3, :3].T + turn[:3, 3]
        for body in links
        if body.collides or not any(one.collides for one in links)
        for turn in (first @ body.world_from_body(),)
    ]
    points = np.concatenate(boxes)
    return vector("low", points.min(axis=0)), vector("high", points.max(axis=0))


def _links(world: World) -> Sequence[tuple[Robot, list[int]]]:
    return [(robot, list(world.robot_state(robot.name).links.values())) for robot in world.robots]


def _box_of_object(world: World, number: int) -> Box:
    placement = world.body(number).placement
    box = collision_box(placement.asset.collision, placement.scale)
    if box is None:
        instances = (drawn.instance for drawn in world.contents.instances)
        one = next(one for one in instances if one.id == number)
        return one.low_m, one.high_m
    return vector("low", box[0]), vector("high", box[1])


def _touches(body: Body, one: Instance, region: Solid) -> bool:
    if body.collides:
        return any(solids_overlap(solid, region) for solid in solids_of_body(body))
    matrix = body.world_from_body()
    corners = _corners(one.low_m, one.high_m)
    return solids_overlap(Solid(corners @ matrix[:3, :3].T + matrix[:3, 3]), region)


def _corners(low_m: Vector3, high_m: Vector3) -> NDArray[np.float64]:
    """Return the (8, 3) corners of a box."""
    return np.array(
        [(x, y, z) for x in (low_m[0], high_m[0]) for y in (low_m[1], high_m[1])
         for z in (low_m[2], high_m[2])]
    )  # fmt: skip
