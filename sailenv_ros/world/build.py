"""From a scene's description to its world: names become assets, ids, bodies and movers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from sailenv_ros.assets.arranging import arranged
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.kept_skies import kept_sky
from sailenv_ros.assets.material_library import MaterialLibrary, material_names
from sailenv_ros.assets.model_materials import finished
from sailenv_ros.assets.outside import Daylight, daylight_of, outside_asset, outside_of
from sailenv_ros.assets.paint import painted
from sailenv_ros.assets.rooms import room_parts
from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.scene.spec import EnvironmentSpec, MoverSpec, ObjectSpec, RoomSpec, SceneSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.model import Asset
from sailenv_ros.types.robots import RobotModel
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.mover_motion import WaypointTrack
from sailenv_ros.world.opening_pieces import as_placed, moving_entries
from sailenv_ros.world.placement import JointPlacement
from sailenv_ros.world.robot_placements import RobotPlacement, link_placements
from sailenv_ros.world.world import World

__all__ = ["build_world", "make_environment", "make_placement", "room_placements"]


def build_world(
    spec: SceneSpec,
    *,
    assets: AssetLibrary,
    categories: CategoryTable,
    seed: int = 0,
    epoch: int = 1,
    next_revision: Callable[[], int] | None = None,
    skies: Mapping[str, Path] | None = None,
    materials: MaterialLibrary | None = None,
    robots: Mapping[str, RobotModel] | None = None,
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
    skies : mapping of str to Path or None
        Files of the photographed skies by name.
    materials : MaterialLibrary or None
        Where materials and pictures come from; None knows no pictures.
    robots : mapping of str to RobotModel or None
        What the scene's robots are, by their names.

    Raises
    ------
    UnknownName, AssetError, InvalidRequest, PhysicsError
        If something cannot be built; nothing is left then.
    """
    stock = {entry.name: assets.get(entry.asset) for entry in spec.objects}
    visitors = spec.lesson_objects
    opened = tuple(moving_entries(spec.objects, stock, visitors))
    if opened:
        spec = spec.model_copy(update={"objects": (*spec.objects, *opened)})
        stock |= {entry.name: assets.get(entry.asset) for entry in opened}
    poses = arranged(spec.objects, stock, spec.room)
    own = [category.to_category() for category in spec.categories]
    table = CategoryTable([*categories.values(), *own])
    found = materials or MaterialLibrary(assets)
    lights = [light.to_light() for light in spec.lights]
    environment = make_environment(spec.environment, skies or {})
    daylight = daylight_of(lights, environment)
    parts = list(room_placements(spec.room, table, found, daylight))
    machines = [
        RobotPlacement(spec=entry, model=(robots or {})[entry.name]) for entry in spec.robots
    ]
    world = World(
        scene=spec.name,
        epoch=epoch,
        next_revision=next_revision,
        placements=[
            *(part for part in parts if part.joint is None),
            *(
                make_placement(
                    entry,
                    as_placed(entry, stock[entry.name], visitors),
                    poses[entry.name],
                    table,
                    seed,
                    materials=found,
                )
                for entry in spec.objects
            ),
            # After the objects, whose ids do not depend on how doors are made.
            *(part for part in parts if part.joint is not None),
            *(link for machine in machines for link in link_placements(machine, table)),
        ],
        robots=machines,
        waiting=spec.lesson_objects.union(e.name for e in spec.objects if e.appear),
        movers=[_mover(entry) for entry in spec.all_movers],
        categories=table,
        lights=lights,
        environment=environment,
        gravity=spec.gravity,
        settled=spec.settled,
        described=spec,
    )
    try:
        for entry in spec.all_movers:
            if entry.keep_looking_at is not None:
                world.movers[entry.name].face(world.gaze(entry.keep_looking_at.to_look_at()), 0)
    except BaseException:
        world.close()
        raise
    return world


def make_environment(spec: EnvironmentSpec, skies: Mapping[str, Path]) -> Environment:
    """Return the surroundings; under a photographed sky its means take the place of the colours.

    Raises
    ------
    UnknownName, AssetError
        If there is no such sky, or it cannot be read.
    """
    environment = spec.to_environment()
    if not environment.sky_map:
        return environment
    sky = kept_sky(environment.sky_map, skies, environment.sky_rotation)
    return replace(
        environment, sky=sky, sky_zenith=sky.zenith, sky_horizon=sky.horizon, sky_ground=sky.ground
    )


def room_placements(
    room: RoomSpec | None,
    categories: CategoryTable,
    materials: MaterialLibrary | None = None,
    daylight: Daylight | None = None,
) -> Iterator[Placement]:
    """Yield the parts of a room, none if there is no room.

    Parameters
    ----------
    room : RoomSpec or None
    categories : CategoryTable
    materials : MaterialLibrary or None
        Where its materials come from; None knows those that are made for rooms.
    daylight : Daylight or None
        In which what lies outside is seen; None leaves that out.
    """
    made = () if room is None else room_parts(room, materials)
    places = {part.asset.display_name: np.asarray(part.position_m) for part in made}
    for part in made:
        joint = None
        if part.joint is not None:
            x, y, z = (np.asarray(part.position_m) - places[part.parent]).tolist()
            joint = JointPlacement(
                spec=part.joint, parent=part.parent, parent_from_rest=Pose((x, y, z))
            )
        yield Placement(
            name=part.asset.display_name,
            asset=part.asset,
            category_id=categories.named(part.asset.category).id,
            pose=Pose(part.position_m),
            static=joint is None,
            joint=joint,
        )
    beyond = None if room is None or daylight is None else outside_asset(room, daylight)
    if room is not None and beyond is not None:
        yield Placement(
            name=beyond.display_name,
            asset=beyond,
            category_id=categories.named(beyond.category).id,
            pose=Pose(),
            static=True,
            outside=outside_of(room, made),
        )


def make_placement(
    entry: ObjectSpec,
    asset: Asset,
    pose: Pose,
    categories: CategoryTable,
    seed: int,
    *,
    start_s: float = 0.0,
    materials: MaterialLibrary | None = None,
) -> Placement:
    """Turn an object's description into what `World.spawn` takes.

    Parameters
    ----------
    entry : ObjectSpec
    asset : Asset
        What it is, as the library has it.
    pose : Pose
        Where it stands.
    categories : CategoryTable
    seed : int
        Of its behaviours' generators.
    start_s : float
        Simulated time at which they start [s].
    materials : MaterialLibrary or None
        Needed for an entry that has materials.

    Raises
    ------
    UnknownName, InvalidRequest
        If something does not exist or does not fit.
    """
    names = material_names(asset)
    asset = _painted(entry, asset, materials)
    for part in asset.parts:
        categories.named(part.category)  # which must be there
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
    return Placement(
        name=entry.name,
        asset=asset,
        category_id=categories.named(entry.category or asset.category).id,
        pose=pose,
        scale=entry.scale,
        static=entry.static,
        mass_kg=entry.mass,
        gravity=entry.gravity,
        friction=entry.friction,
        restitution=entry.restitution,
        linear_velocity=entry.velocity,
        angular_velocity=entry.angular_velocity_rad_s,
        behaviours=tuple(behaviours),
        materials=names,
        joint=_joint(entry),
        entry=entry,
    )


def _joint(entry: ObjectSpec) -> JointPlacement | None:
    if entry.joint is None:
        return None
    return JointPlacement(
        spec=entry.joint, parent=entry.joint.parent or "", parent_from_rest=entry.pose
    )


def _painted(entry: ObjectSpec, asset: Asset, materials: MaterialLibrary | None) -> Asset:
    model = painted(
        asset.model, colour=entry.colour, metallic=entry.metallic, roughness=entry.roughness
    )
    if entry.materials:
        stock = materials or MaterialLibrary(AssetLibrary())
        model = finished(model, entry.materials, stock, entry.scale)
    return asset if model is asset.model else replace(asset, model=model)


def _mover(entry: MoverSpec) -> Mover:
    track = None
    if entry.waypoints:
        track = WaypointTrack(
            waypoints=entry.waypoint_poses, total_time_s=entry.total_time, loop=entry.loop
        )
    body = entry.body
    begins_as = None
    if body is not None:
        begins_as = body.to_rigid_body(), (body.velocity, body.angular_velocity_rad_s)
    return Mover(
        name=entry.name,
        start=entry.pose,
        track=track,
        controller=entry.controller,
        begins_as=begins_as,
        total_time_s=entry.total_time,
        loop=entry.loop,
    )
