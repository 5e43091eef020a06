"""Pairs of links of a robot that pass through one another."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

from sailenv_ros.types.robots import RobotModel
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.jointed_bodies import JointedBody

__all__ = ["let_pass"]


def let_pass(client: BulletClient, model: RobotModel, bodies: Mapping[str, JointedBody]) -> None:
    """Let links not collide that a joint joins, or that stand in one another now.

    Parameters
    ----------
    client : BulletClient
    model : RobotModel
    bodies : mapping of str to JointedBody
        In the engine, by the links' names.
    """
    group: dict[str, str] = {}
    beside: set[tuple[str, str]] = set()
    for link in model.links:
        own = group[link.parent] if link.parent and link.joint.type == "fixed" else link.name
        group[link.name] = own
        if link.parent:
            beside.add((group[link.parent], own))
    for one, two in itertools.combinations([link.name for link in model.links], 2):
        first, second = bodies[one], bodies[two]
        if not first.collides or not second.collides:
            continue
        a, b = group[one], group[two]
        near = a == b or (a, b) in beside or (b, a) in beside
        body, tree = first.bullet_id, first.tree
        assert tree is not None
        if near or client.getClosestPoints(body, body, 0.0, first.link, second.link):
            tree.let_pass(first.place, second.place)
