"""From a scene's description to its world: names become assets, ids, bodies and movers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from sailenv_ros.assets.library import AssetLibrary
from sailenv_ros.assets.paint import painted
from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.labels import CategoryTable
from sailenv_ros.model import Asset
from sailenv_ros.scene.spec import MoverSpec, ObjectSpec, SceneSpec
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.mover import Mover, WaypointTrack
from sailenv_ros.world.world import World

__all__ = ["build_world", "make_placement"]


def build_world(
    spec: SceneSpec,
    *,
    assets: AssetLibrary,
    categories: CategoryTable,
    seed: int,
    epoch: int,
    next_revision: Callable[[], int],
) -> World:
    """Build the world of a scene.

    Parameters
    ----------
    spec : SceneSpec
    assets : AssetLibrary
    categories : CategoryTable
        The fixed table; the scene's own are added.
    seed : int
        Of the behaviours' generators.
    epoch, next_revision
        As `World` takes them.

    Raises
    ------
    UnknownName, AssetError, InvalidRequest, PhysicsError
        If something cannot be built; nothing is left then.
    """
    own = [category.to_category() for category in spec.categories]
    table = CategoryTable([*categories.values(), *own])
    return World(
        scene=spec.name,
        epoch=epoch,
        next_revision=next_revision,
        placements=[make_placement(entry, assets, table, seed) for entry in spec.objects],
        movers=[_mover(entry) for entry in spec.all_movers],
        categories=table,
        lights=[light.to_light() for light in spec.lights],
        environment=spec.environment.to_environment(),
        gravity=spec.gravity,
    )


def make_placement(
    entry: ObjectSpec,
    assets: AssetLibrary,
    categories: CategoryTable,
    seed: int,
    *,
    start_s: float = 0.0,
) -> Placement:
    """Turn an object's description into what `World.spawn` takes.

    Parameters
    ----------
    start_s : float
        Simulated time at which its behaviours start [s].

    Raises
    ------
    UnknownName, AssetError, InvalidRequest
        If something does not exist or does not fit.
    """
    asset = _painted(entry, assets.get(entry.asset))
    behaviours = [
        start_behaviour(
            b.type,
            b.parameters,
            seed=seed,
            object_name=entry.name,
            place=place,
            start_s=start_s,
        )
        for place, b in enumerate(entry.behaviours)
    ]
    x, y, z = (math.radians(rate) for rate in entry.angular_velocity)
    return Placement(
        name=entry.name,
        asset=asset,
        category_id=categories.named(entry.category or asset.category).id,
        pose=entry.pose,
        scale=entry.scale,
        static=entry.static,
        mass_kg=entry.mass,
        gravity=entry.gravity,
        friction=entry.friction,
        restitution=entry.restitution,
        linear_velocity=entry.velocity,
        angular_velocity=(x, y, z),
        behaviours=tuple(behaviours),
    )


def _painted(entry: ObjectSpec, asset: Asset) -> Asset:
    model = painted(
        asset.model, colour=entry.colour, metallic=entry.metallic, roughness=entry.roughness
    )
    return asset if model is asset.model else replace(asset, model=model)


def _mover(entry: MoverSpec) -> Mover:
    track = None
    if entry.waypoints:
        track = WaypointTrack(
            waypoints=entry.waypoint_poses, total_time_s=entry.total_time, loop=entry.loop
        )
    return Mover(name=entry.name, start=entry.pose, track=track, controller=entry.controller)
