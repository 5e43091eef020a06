"""Light on what can move, where it stands: rays from points of its surface, fitted by few terms.

A probe in the air knows neither what an object stands on nor what stands beside it, nor that the
sides of something large are lit unlike. So rays from the object's own surface gather what arrives
there from everything around and straight from each lamp, and a fit by normal and place says it for
all of the surface. Each side has its own places: of a door one may face a lamp, the other the dark.
From `BakedScene` and objects to `ObjectLight`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.settings import INSIDE_SHARE
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.light_terms import fitted_terms, terms_at
from sailenv_ros.light.relight.quality import QUICK, Quality
from sailenv_ros.light.relight.ray_world import RayWorld, ray_world
from sailenv_ros.light.relight.scene_changes import (
    Change,
    PlacedInstance,
    placed_instances,
    ray_instances,
)
from sailenv_ros.light.relight.sent_light import sent_by_light, sent_by_probes
from sailenv_ros.light.relight.vertex_points import VertexPoints, vertex_points
from sailenv_ros.native.ray_types import RAY_LIGHT
from sailenv_ros.native.relight_kernels import direct_light_delta, gather_change
from sailenv_ros.rays.model_triangles import triangles_of
from sailenv_ros.rays.ray_patterns import low_discrepancy_points, sequence_points
from sailenv_ros.rays.self_occlusion import LEAST_WEIGHT, vertex_occlusion
from sailenv_ros.rays.static_geometry import PlacedModel
from sailenv_ros.types.baked_light import LIGHT_TERMS, ObjectLight
from sailenv_ros.types.colour import HALF_MOST, LUMINANCE
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.light_shapes import light_record
from sailenv_ros.types.model import Model

__all__ = ["ObjectLighting", "Place", "PlacedObject", "SurfacePoints", "near_changes"]

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]

Place: TypeAlias = tuple[int, Model, tuple[float, float, float], bytes]
"""Instance id, model, scale, and bytes of the pose."""

WHOLE, INSIDE = 2, 3
"""States of points: all of their light is wanted; they lie inside of something."""

HIDDEN_M = 0.1
"""Points that see nothing farther than a few centimetres are seldom seen, and count less: by the
harmonic mean of the distances of what they see over this [m]."""


LEAST_OPEN = 0.1
"""Open share below which points tell too little of what arrives there to divide by it."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class PlacedObject(PlacedModel):
    """An object that can move, where it is.

    Attributes
    ----------
    moves : bool
        Whether it moves now.
    """

    moves: bool = False

    @property
    def place(self) -> Place:
        """Key of the object at its place; it keeps the model, told by identity."""
        return self.id, self.model, self.scale, self.world_from_body.tobytes()

    @property
    def ball(self) -> tuple[Doubles, float]:
        """Centre [m], world frame, and radius [m] of a ball around it."""
        bounds = self.model.bounds() * np.asarray(self.scale)
        pose = self.world_from_body
        radius = float(np.linalg.norm(np.ptp(bounds, axis=0)) / 2.0)
        return pose[:3, :3] @ bounds.mean(axis=0) + pose[:3, 3], radius


class SurfacePoints:
    """Points on models' surfaces, chosen once for each model and number."""

    def __init__(self) -> None:
        self._made: dict[tuple[int, int], tuple[Model, Doubles, Doubles, Doubles]] = {}

    def of(self, model: Model, count: int) -> tuple[Doubles, Doubles, Doubles]:
        """Return (P, 3) positions and unit normals in the model's own frame, and (P,) open shares.

        These say how much of the light from around the model itself leaves them; of models with
        glass nothing is said.
        """
        made = self._made.get((id(model), count))
        if made is None:
            made = self._made[id(model), count] = model, *_surface_points(model, count)
        return made[1:]


class ObjectLighting:
    """A scene as rays from objects meet it, with the changes of what was baked.

    Parameters
    ----------
    scene : BakedScene
    changes : sequence of Change
        What was baked and stands elsewhere now.
    points : SurfacePoints

    Attributes
    ----------
    world : RayWorld
        All but what can move.
    """

    def __init__(self, scene: BakedScene, changes: Sequence[Change], points: SurfacePoints) -> None:
        self._scene, self._points = scene, points
        layers = scene.baked.layers
        self._layers = len(layers)
        lights = {n: layer.light for n, layer in enumerate(layers) if layer.light is not None}
        self._area = [n for n, light in lights.items() if light.type == "area"]
        areas = (light_record(lights[n]) for n in self._area)
        self._areas = np.concatenate([np.zeros(0, RAY_LIGHT), *areas])
        self._lamps = {
            n: light_record(light)
            for n, light in lights.items()
            if light.type not in ("area", "directional")
        }
        self._everything = np.full(len(scene.sent), WHOLE, np.uint8)
        self._placed: dict[int, tuple[tuple[Place, bool], PlacedInstance]] = {}
        self.world = ray_world(scene, changes, scene.sent, scene.sent, settled=True)

    def light_on(
        self,
        thing: PlacedObject,
        near: Sequence[PlacedObject],
        quality: Quality,
        *,
        shading: bool = False,
    ) -> ObjectLight:
        """Return the light on an object.

        Parameters
        ----------
        thing : PlacedObject
        near : sequence of PlacedObject
            What else can move and stands near enough to count.
        quality : Quality
        shading : bool
            Whether the object's own shadow counts on what it faces from near: for what it sends
            back there.
        """
        others = [self.placed(one) for one in near]
        points, turned, share = self._points.of(thing.model, quality.object_points)
        positions, normals = _placed_points(thing, points, turned)
        hides = not shading and bool((share < 1.0).any())
        solid = self._scene.shape_of(thing.model, thing.scale, None)
        dark = np.zeros((6, 3 * self._layers), np.float32)
        alone = PlacedInstance(solid, thing.world_from_body, None, dark, True, True)
        own = ray_instances([alone])[0] if shading else None
        if hides:
            # In its folds light comes from where they are open, not from all around: what arrives
            # there is found with the object itself, and over the share that drawing takes of it.
            others.append(alone)
        world = self.world.with_more(others)
        bounced, direct, weights = self._gathered(world, own, positions, normals, quality)
        if hides:
            share = np.maximum(share, LEAST_OPEN)
            bounced, direct = bounced / share[:, None], direct / share[:, None]
            weights = weights * share
        axes = thing.world_from_body[:3, :3].T
        fit = fitted_terms(
            positions.astype(np.float64),
            normals.astype(np.float64),
            _counted(weights, normals, axes),
            axes,
        )
        by_layer = (fit @ bounced).reshape(LIGHT_TERMS, self._layers, 3).transpose(1, 0, 2)
        light = ObjectLight(
            bounced=np.ascontiguousarray(by_layer, np.float32),
            direct=np.ascontiguousarray((fit @ direct).T, np.float32),
            axes=np.ascontiguousarray(axes, np.float32),
        )
        asked = vertex_points(thing.model) if quality.at_vertices else None
        return light if asked is None else self._at_vertices(light, thing, asked, world, quality)

    def _at_vertices(
        self,
        light: ObjectLight,
        thing: PlacedObject,
        asked: VertexPoints,
        world: RayWorld,
        quality: Quality,
    ) -> ObjectLight:
        """Return the light on an object with what rays find at its vertices."""
        count = len(asked.positions)
        few = replace(quality, object_rays=asked.ray_count, area_rays=8, light_rays=4)
        positions, normals = _placed_points(thing, asked.positions, asked.normals)
        bounced, direct, _ = self._gathered(world, None, positions, normals, few)
        if asked.is_veil:
            bounced = bounced * asked.open_shares[:, None]
            direct = direct * asked.open_shares[:, None]
        terms = terms_at(
            positions.astype(np.float64), normals.astype(np.float64), light.axes.astype(np.float64)
        )
        fitted = np.empty((self._layers, count, 2))
        fitted[..., 0] = (light.bounced @ LUMINANCE) @ terms.T
        fitted[..., 1] = light.direct @ terms.T
        fitted *= asked.open_shares[:, None]
        of_colours = (bounced.reshape(count, self._layers, 3) @ LUMINANCE).T
        found, fitted = asked.at_vertices(np.stack([of_colours, direct.T], axis=-1), fitted)
        return replace(light, found=_halves(found), fitted=_halves(fitted))

    def placed(self, thing: PlacedObject) -> PlacedInstance:
        """Return an object as rays meet it; the same one until it has moved."""
        place, known = (thing.place, thing.moves), self._placed.get(thing.id)
        if known is not None and known[0] == place:
            return known[1]
        pose = thing.world_from_body
        shape = self._scene.shape_of(thing.model, thing.scale, None)
        if thing.moves:
            probes, grid = self._scene.light_in_air, self._scene.baked.probes
            sent = sent_by_probes(probes, grid, thing.model, thing.scale, pose)
        else:
            points = _placed_points(thing, *self._points.of(thing.model, QUICK.object_points)[:2])
            sent = sent_by_light(
                self.light_on(thing, (), QUICK, shading=True), *points, thing.model
            )
        made = PlacedInstance(shape, pose, None, sent, True, True)
        self._placed[thing.id] = place, made
        return made

    def _gathered(
        self,
        world: RayWorld,
        own: NDArray[np.void] | None,
        positions: Floats,
        normals: Floats,
        quality: Quality,
    ) -> tuple[Doubles, Doubles, Doubles]:
        """Return (P, 3 L) bounced, (P, L) direct irradiance / pi, and (P,) how much each counts."""
        count = len(positions)
        found, bounced, of_areas, nearness = gather_change(
            world.record, positions, normals, np.full(count, WHOLE, np.uint8),
            low_discrepancy_points(quality.object_rays), self._areas,
            sequence_points(quality.area_rays), 0.0, inside_share=INSIDE_SHARE, own=own, threads=1,
        )  # fmt: skip
        direct = np.zeros((count, self._layers))
        direct[:, self._area] = of_areas
        for number, lamp in self._lamps.items():
            state, value, _ = direct_light_delta(
                world.record, lamp, positions, normals, np.zeros(count, np.int32),
                self._everything, sequence_points(quality.light_rays), threads=1,
            )  # fmt: skip
            direct[:, number] = np.where(state > 0, value, 0.0)
        weights = np.clip(nearness.astype(np.float64) / HIDDEN_M, LEAST_WEIGHT, 1.0)
        return bounced.astype(np.float64), direct, np.where(found == INSIDE, 1e-4, weights)


def near_changes(
    scene: BakedScene, things: Sequence[PlacedObject], changes: Sequence[Change], within_m: float
) -> frozenset[int]:
    """Return the ids of objects near furniture that has changed, where it stood or stands."""
    furniture = [part for change in changes for part in placed_instances(scene, change, None)]
    return frozenset(
        thing.id for thing in things if any(_is_near(thing, part, within_m) for part in furniture)
    )


def _halves(values: Doubles) -> NDArray[np.float16]:
    return np.clip(values, -HALF_MOST, HALF_MOST).astype(np.float16)


def _is_near(thing: PlacedObject, part: PlacedInstance, within_m: float) -> bool:
    centre, radius = thing.ball
    inverse = invert(part.pose)
    own = inverse[:3, :3] @ centre + inverse[:3, 3]
    tree = part.shape.tree
    away = np.maximum(np.maximum(tree.low - own, own - tree.high), 0.0)
    return float(np.linalg.norm(away)) < radius + within_m


def _placed_points(
    thing: PlacedObject, positions: Doubles, normals: Doubles
) -> tuple[Floats, Floats]:
    """Return (P, 3) positions [m] and unit normals of points of an object, world frame."""
    scale, pose = np.asarray(thing.scale), thing.world_from_body
    turned = (normals / scale) @ pose[:3, :3].T
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)
    placed = (positions * scale) @ pose[:3, :3].T + pose[:3, 3]
    return np.ascontiguousarray(placed, np.float32), np.ascontiguousarray(turned, np.float32)


def _surface_points(model: Model, count: int) -> tuple[Doubles, Doubles, Doubles]:
    """Return what `SurfacePoints.of` says, of points spread over a model's area."""
    every = triangles_of(model)
    solid = every.passes == 0.0
    chosen = solid if solid.any() else np.ones(len(solid), bool)
    corners = every.corners[chosen].astype(np.float64)
    normals = every.normals[chosen].astype(np.float64)
    ends = np.cumsum(every.areas_m2[chosen])
    at = (np.arange(count) + 0.5) / count * ends[-1]
    triangle = np.minimum(np.searchsorted(ends, at), len(ends) - 1)
    u, v = low_discrepancy_points(count).astype(np.float64).T
    root = np.sqrt(v)
    # The first number of the pattern rises with the index: another one chooses within triangles.
    u = np.modf(u * 0.618034 * count)[0]
    weights = np.stack([1.0 - root, root * (1.0 - u), root * u], axis=1)
    points = np.einsum("pc,pcx->px", weights, corners[triangle])
    turned = np.einsum("pc,pcx->px", weights, normals[triangle])
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)
    if not solid.all():
        return points, turned, np.ones(count)
    hidden = [
        occlusion[part.mesh.triangles]
        for part, occlusion in zip(model.parts, vertex_occlusion(model), strict=True)
    ]
    own = np.concatenate(hidden)[triangle]
    return points, turned, 1.0 - np.einsum("pc,pc->p", weights, own)


def _counted(weights: Doubles, normals: Floats, axes: Doubles) -> Doubles:
    """Return (P,) weights in which each side's least hidden point counts fully.

    A side that is hidden altogether, as that of a door beside another one, is as dark as it is:
    else what the other sides have would be taken for it.
    """
    along = normals.astype(np.float64) @ axes.T
    axis = np.abs(along).argmax(axis=1)
    side = axis + 3 * (along[np.arange(len(axis)), axis] < 0.0)
    most = np.zeros(6)
    np.maximum.at(most, side, weights)
    # Of sides within something nothing is known.
    most[most < LEAST_WEIGHT] = 1.0
    counted: Doubles = weights / most[side]
    return counted
