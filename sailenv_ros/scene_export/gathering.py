"""A world, or one asset, → `ExportedScene`: everything that any format holds, read once."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Sequence
from contextlib import closing
from typing import Literal

import numpy as np

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.scene_export.contents import (
    BodyJoint,
    ExportedBody,
    ExportedCamera,
    ExportedPiece,
    ExportedScene,
)
from sailenv_ros.scene_export.light_map import LitParts, light_of
from sailenv_ros.scene_export.motion import Moment, check_samples, motion_of
from sailenv_ros.scene_export.names import identifier
from sailenv_ros.scene_export.sharing import Sharing
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.space.outlines import solids_of
from sailenv_ros.types.agents import AgentSpec, due_steps
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import (
    Asset,
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    Material,
    ModelPart,
    SphereShape,
    TriangleShape,
)
from sailenv_ros.types.snapshot import DrawnInstance
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.build import build_world
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.world import World

__all__ = [
    "agents_in",
    "asset_world",
    "exported_asset",
    "exported_world",
    "scaled_shape",
    "with_motion",
]

Vector3 = tuple[float, float, float]


def exported_world(
    world: World, agents: AgentTable | None = None, *, light: Literal["lamps", "baked"] = "lamps"
) -> ExportedScene:
    """Return a world as it is now, with the cameras of agents.

    Raises
    ------
    InvalidRequest
        If its light is wanted as it was baked, and is not.
    """
    light_map = light_of(world) if light == "baked" else None
    lit = None if light_map is None else LitParts(light_map)
    snapshot = world.snapshot()
    contents = snapshot.contents
    lamps = _Lamps(contents.lights)
    pieces: dict[int, list[ExportedPiece]] = {}
    for drawn in contents.instances:
        instance = drawn.instance
        owner = instance.parent if instance.is_part else instance.id
        parts = lamps.lit(drawn)
        if instance.id in snapshot.deformations:
            parts = _deformed(parts, snapshot.deformations[instance.id])
        parts, places = (parts, ()) if lit is None else lit.of(instance.id, parts)
        piece = ExportedPiece(
            instance=instance, parts=parts, deforms=drawn.deforms, light_places=places
        )
        pieces.setdefault(owner, []).append(piece)
    for own in pieces.values():
        own.sort(key=lambda piece: piece.instance.is_part)
    table = agents or AgentTable()
    return ExportedScene(
        name=contents.scene,
        bodies=tuple(_body(body, pieces[id_]) for id_, body in world.numbered_bodies),
        lights=contents.lights,
        environment=contents.environment,
        cameras=tuple(
            ExportedCamera(
                name=record.spec.name,
                intrinsics=record.spec.intrinsics,
                pose=table.camera(record, world).pose,
            )
            for record in table
        ),
        gravity=world.gravity,
        light_map=light_map,
    )


def with_motion(
    scene: ExportedScene, world: World, agents: AgentTable, duration_s: float, rate_hz: float
) -> ExportedScene:
    """Step a world on; return the scene with how it moves meanwhile.

    Parameters
    ----------
    scene : ExportedScene
        The world as it is now.
    world : World
    agents : AgentTable
    duration_s, rate_hz : float
        So long [s], with so many samples a second.

    Raises
    ------
    InvalidRequest
        If there are too few or too many samples.
    """
    count = math.floor(duration_s * rate_hz + 1e-9) + 1
    check_samples(count)
    moments, taken = [], 0
    for due in due_steps(rate_hz, count):
        world.step(due - taken)
        taken = due
        cameras = {one.spec.name: agents.camera(one, world).pose for one in agents}
        moments.append(
            Moment(time_s=1e-9 * world.sim_time_ns, states=world.states(), cameras=cameras)
        )
    ids = [body.instance.id for body in scene.bodies]
    return dataclasses.replace(scene, motion=motion_of(moments, ids, rate_hz))


def agents_in(world: World, specs: Iterable[AgentSpec]) -> AgentTable:
    """Return agents as a scene file describes them.

    Raises
    ------
    UnknownName
        If one follows a mover that is not there.
    """
    table = AgentTable()
    table.add_missing(specs, world)
    return table


def exported_asset(asset: Asset, categories: CategoryTable) -> ExportedScene:
    """Return one asset at the origin, with what opens of it on joints."""
    with closing(asset_world(asset, categories)) as world:
        scene = exported_world(world)
    whole = asset if asset.still is None else asset.still
    first, *opening = scene.bodies
    own = dataclasses.replace(
        first,
        mass_kg=whole.mass_kg,
        centre_m=whole.centre_of_mass_m,
        inertia_kg_m2=_box_inertia(first.shapes, whole.mass_kg),
    )
    return dataclasses.replace(scene, name=own.name, bodies=(own, *opening), environment=None)


def asset_world(asset: Asset, categories: CategoryTable) -> World:
    """Return a world with nothing but an asset, which stands still at the origin."""
    assets = AssetLibrary()
    for one in (asset, *(part.asset for part in asset.moving)):
        if not assets.has(one.name):
            assets.add(one)
    entry = {"name": identifier(asset.name)[:40], "asset": asset.name, "static": True}
    spec = SceneSpec.model_validate({"version": 1, "settled": False, "objects": [entry]})
    return build_world(spec, assets=assets, categories=categories)


def _box_inertia(shapes: Sequence[CollisionShape], mass_kg: float) -> Vector3:
    """Return the moments of inertia of the box around shapes, as the engine takes them."""
    solids = list(solids_of(shapes, (1.0, 1.0, 1.0), np.eye(4)))
    if not solids:
        return (mass_kg, mass_kg, mass_kg)
    low = np.min([solid.points.min(axis=0) - solid.radius_m for solid in solids], axis=0)
    high = np.max([solid.points.max(axis=0) + solid.radius_m for solid in solids], axis=0)
    x, y, z = ((high - low) ** 2).tolist()
    share = mass_kg / 12.0
    return (share * (y + z), share * (x + z), share * (x + y))


class _Lamps:
    """Materials of drawn instances, with the light that lamps give them as emission.

    Parameters
    ----------
    lights : sequence of Light
    """

    def __init__(self, lights: Sequence[Light]) -> None:
        self._lights = lights
        self._shared = Sharing()
        self._made: dict[tuple[int, Vector3], Material] = {}

    def lit(self, drawn: DrawnInstance) -> tuple[ModelPart, ...]:
        """Return an instance's parts; equal materials are the same object."""
        power = drawn.lamp_power(self._lights)
        parts = drawn.model.parts
        if drawn.outside is not None:
            parts = tuple(_with(part, self._dark(part.material)) for part in parts)
        elif any(power):
            parts = tuple(_with(part, self._glowing(part.material, power)) for part in parts)
        return tuple(self._shared.part(part) for part in parts)

    def _dark(self, material: Material) -> Material:
        """Return the material of what takes no light: all that is seen of it is its emission."""
        key = id(material), (0.0, 0.0, 0.0)
        if key not in self._made:
            black = (0.0, 0.0, 0.0, material.base_colour[3])
            self._made[key] = dataclasses.replace(material, base_colour=black)
        return self._made[key]

    def _glowing(self, material: Material, power: Vector3) -> Material:
        if not any(material.glow):
            return material
        key = id(material), power
        if key not in self._made:
            sums = zip(material.emission, material.glow, power, strict=True)
            red, green, blue = (own + glow * light for own, glow, light in sums)
            self._made[key] = dataclasses.replace(
                material, emission=(red, green, blue), glow=(0.0, 0.0, 0.0)
            )
        return self._made[key]


def _deformed(parts: Sequence[ModelPart], deformation: Deformation) -> tuple[ModelPart, ...]:
    """Return parts with their vertices where they are now."""
    return tuple(
        dataclasses.replace(
            part,
            mesh=dataclasses.replace(part.mesh, positions=moved.positions, normals=moved.normals),
        )
        for part, moved in zip(parts, deformation.meshes, strict=True)
    )


def _with(part: ModelPart, material: Material) -> ModelPart:
    return dataclasses.replace(part, material=material)


def _body(body: Body, pieces: Sequence[ExportedPiece]) -> ExportedBody:
    placement = body.placement
    sx, sy, sz = placement.scale
    x, y, z = placement.asset.centre_of_mass_m
    ix, iy, iz = (float(moment) for moment in body.inertia_kg_m2)
    return ExportedBody(
        name=placement.name,
        asset=placement.asset.name,
        pieces=tuple(pieces),
        pose=body.pose(),
        scale=placement.scale,
        static=placement.static,
        joint=_joint(body),
        mass_kg=body.mass_kg,
        centre_m=(x * sx, y * sy, z * sz),
        inertia_kg_m2=(ix, iy, iz),
        shapes=tuple(scaled_shape(one, placement.scale) for one in placement.asset.collision),
        friction=placement.friction,
        restitution=placement.restitution,
        gravity=placement.gravity,
        is_outside=placement.outside is not None,
    )


def _joint(body: Body) -> BodyJoint | None:
    if not isinstance(body, JointedBody) or body.joint.spec.type == "free":
        return None
    spec = body.joint.spec
    return BodyJoint(
        type=body.joint.spec.type,
        parent=body.joint.parent,
        parent_from_rest=body.joint.parent_from_rest,
        axis=spec.unit_axis,
        origin_m=spec.origin,
        limits=spec.limits if spec.moves else None,
        position=body.joint_state()[0],
        friction=spec.friction,
        damping=spec.damping,
        effort=spec.effort,
        acts=spec.soft_close is not None or spec.detents is not None,
    )


def scaled_shape(shape: CollisionShape, scale: Vector3) -> CollisionShape:
    """Return a collision shape at a scale that `world.collision` has accepted for it."""
    if scale == (1.0, 1.0, 1.0):
        return shape
    factors = np.asarray(scale)
    if isinstance(shape, ConvexShape):
        return ConvexShape(points=shape.points * factors)
    if isinstance(shape, TriangleShape):
        return dataclasses.replace(shape, positions=shape.positions * factors)
    centre = _product(shape.centre_m, scale)
    if isinstance(shape, BoxShape):
        half = _product(shape.half_extents_m, scale)
        return dataclasses.replace(shape, half_extents_m=half, centre_m=centre)
    if isinstance(shape, SphereShape):
        return SphereShape(radius_m=shape.radius_m * scale[0], centre_m=centre)
    assert isinstance(shape, CylinderShape)
    return CylinderShape(
        radius_m=shape.radius_m * scale[0], height_m=shape.height_m * scale[2], centre_m=centre
    )


def _product(vector: Vector3, scale: Vector3) -> Vector3:
    x, y, z = (a * b for a, b in zip(vector, scale, strict=True))
    return x, y, z
