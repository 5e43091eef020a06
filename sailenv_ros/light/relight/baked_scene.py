"""A scene as its light was baked: texels, patches of them, what they give back, shapes for rays.

From a `BakedLight` and the objects that it was baked for. Made once for a bake, when something
moves first. Knows no change.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.lamp_glow import glows_of
from sailenv_ros.light.bake.returned_light import returned
from sailenv_ros.light.bake.sky_picture import sky_picture
from sailenv_ros.light.relight.baked_texels import BakedTexels, baked_texels, patch_means
from sailenv_ros.light.relight.found_light import FoundLight
from sailenv_ros.rays.light_rays import glass_of
from sailenv_ros.rays.model_triangles import triangles_of
from sailenv_ros.rays.solid_models import SolidModel, solid_model
from sailenv_ros.rays.static_geometry import StaticGeometry, static_geometry_of
from sailenv_ros.types.baked_light import BakedLight, Unwrapping
from sailenv_ros.types.colour import LINEAR_OF_SRGB8
from sailenv_ros.types.digests import once
from sailenv_ros.types.model import Material, Model
from sailenv_ros.types.snapshot import DrawnInstance, SceneContents, WorldSnapshot

__all__ = ["BakedScene", "TexelPatches", "albedo_of_model"]

Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class TexelPatches:
    """Tiles of texels, as far as they belong to one object and face one way.

    Attributes
    ----------
    of_map : (side, side) int32
        Of each texel of the map, -1 for none.
    of_texel : (N,) int32
    places, positions, normals : (P, 2), (P, 3), (P, 3) float32
        Column and row, world position [m] and unit normal of the texel that stands for each.
    owners : (P,) int32
        Instance id.
    size : (P,) float32
        How many texels each has.
    albedo : (P, 3) float32
    emission : (P, 3) float32
    materials : (P,) int32
        Place of each one's material in `BakedScene.materials`.
    """

    of_map: NDArray[np.int32]
    of_texel: NDArray[np.int32]
    places: Floats
    positions: Floats
    normals: Floats
    owners: NDArray[np.int32]
    size: Floats
    albedo: Floats
    emission: Floats
    materials: NDArray[np.int32]

    def means(self, values: Floats) -> Floats:
        """Return (P,) float32: means of (N,) values of texels."""
        return patch_means(self.of_texel, values, self.size)


class BakedScene:
    """Bake in the form that relighting needs; arrays are read-only by agreement.

    Parameters
    ----------
    baked : BakedLight
    contents : SceneContents
        Holds the objects that it was baked for.
    threads : int

    Attributes
    ----------
    baked : BakedLight
    drawn : dict of int to DrawnInstance
        What has a chart, by instance id.
    side : int
        Of the light map [texels].
    places, positions, normals, owners : (N,) int32, (N, 3), (N, 3) float32, (N,) int32
        Place in the map, world position [m], unit normal and instance of each texel in use.
    patches : TexelPatches
    irradiance : (P, C) float32
        Means of the layers' bounced light, the three colours of each layer in turn.
    direct : (P, L) float32
        Means of the layers' direct light.
    glows : dict of int to (P, 3) float32
        What shades of lamps emit, for white light of intensity 1, by the layer of that light.
    sent : (P, C) float32
        What patches send out by these; see `radiance`.
    emitters : (E, 4) float32
        Small things that shine, as they stood; see `emitters_of`.
    brightest : float
        Bounced light of all layers that nine patches of ten do not exceed.
    materials : tuple of Material
    panes : tuple
        Glass of what stands still; see `glass_of`.
    sky : (H, 2 H, 3) float32
    found : FoundLight
        For others who show this scene.
    """

    def __init__(self, baked: BakedLight, contents: SceneContents, threads: int) -> None:
        self.baked, self.found = baked, FoundLight()
        self.drawn = {
            drawn.instance.id: drawn
            for drawn in contents.instances
            if drawn.instance.id in baked.charts and drawn.model.triangle_count
        }
        self._shapes: dict[tuple[int, tuple[float, ...], int], tuple[object, SolidModel]] = {}
        self.side = len(baked.layers[0].direct)
        geometry = static_geometry_of(_as_baked(baked, contents, tuple(self.drawn.values())))
        self.materials = geometry.materials
        self._lay_out(geometry, threads, {d.instance.id: d.lit_by for d in self.drawn.values()})
        self.panes = glass_of(geometry)
        self.sky = np.ascontiguousarray(sky_picture(contents.environment), np.float32)
        with ThreadPoolExecutor(max(threads, 1)) as pool:
            list(pool.map(self.shape, self.drawn))

    def shape(self, instance_id: int) -> SolidModel:
        """Return the shape of an instance that was baked."""
        drawn = self.drawn[instance_id]
        return self.shape_of(drawn.model, drawn.scale, self.baked.charts[instance_id].unwrapping)

    def shape_of(
        self, model: Model, scale: tuple[float, float, float], flat: Unwrapping | None
    ) -> SolidModel:
        """Return a model's shape; each is made once."""
        key = id(model), scale, id(flat)
        found = self._shapes.get(key)
        if found is None:
            found = self._shapes[key] = (model, flat), solid_model(model, scale, flat)
        return found[1]

    @cached_property
    def light_in_air(self) -> Floats:
        """(Z, Y, X, 4, C) float32: all light of the probes, the three colours of each layer."""
        layers = self.baked.layers
        probes = [layer.probe_bounced.astype(np.float32) + layer.probe_direct for layer in layers]
        return np.ascontiguousarray(np.concatenate(probes, axis=-1))

    def looks_with(self, painted: Mapping[int, Model]) -> tuple[Floats, Floats]:
        """Return albedo and emission, (P, 3) float32 each, of the patches.

        Parameters
        ----------
        painted : mapping of int to Model
            Models of the same shape with other materials, by instance id.
        """
        albedo, emission = self.patches.albedo.copy(), self.patches.emission.copy()
        for id_, model in painted.items():
            own = self.patches.owners == id_
            looks = {
                id(before.material): _look(after.material)
                for before, after in zip(self.drawn[id_].model.parts, model.parts, strict=True)
            }
            for place in np.unique(self.patches.materials[own]):
                chosen = own & (self.patches.materials == place)
                albedo[chosen], emission[chosen] = looks[id(self.materials[place])]
        return albedo, emission

    def radiance(
        self,
        irradiance: Floats,
        direct: Floats,
        albedo: Floats | None = None,
        emission: Floats | None = None,
    ) -> Floats:
        """Return (P, C) float32: what patches send out by what arrives there.

        Parameters
        ----------
        irradiance : (P, C) float32
        direct : (P, L) float32
        albedo, emission : (P, 3) float32 or None
            None takes that of the bake.
        """
        albedo = self.patches.albedo if albedo is None else albedo
        layers = direct.shape[1]
        light = irradiance.reshape(-1, layers, 3) + direct[:, :, None]
        radiance = light * albedo[:, None, :]
        radiance[:, 0] += self.patches.emission if emission is None else emission
        for number, glow in self.glows.items():
            radiance[:, number] += glow
        return np.ascontiguousarray(radiance.reshape(len(direct), -1), np.float32)

    def _lay_out(
        self, geometry: StaticGeometry, threads: int, lit_by: Mapping[int, Sequence[str]]
    ) -> None:
        texels = baked_texels(self.baked, geometry, lit_by, max(threads, 1))
        ids = np.array([instance.id for instance in geometry.instances], np.int32)
        self.places, self.positions, self.normals = texels.places, texels.positions, texels.normals
        self.owners = ids[geometry.owner[texels.triangle]]
        self.patches = self._patches(geometry, texels)
        layer_of = {
            layer.light.name: n
            for n, layer in enumerate(self.baked.layers)
            if layer.light is not None
        }
        # Most texels are of nothing that glows.
        glowing = np.array([*(any(look.glow) for look in geometry.materials), False])
        own = np.flatnonzero(glowing[geometry.material[texels.triangle]])
        patches, size = self.patches.of_texel[own], self.patches.size
        self.glows = {
            layer_of[name]: np.stack([patch_means(patches, part, size) for part in glow.T], axis=1)
            for name, glow in glows_of(geometry, texels.triangle[own], lit_by).items()
            if name in layer_of
        }
        self.irradiance, self.direct = texels.irradiance, texels.direct
        self.emitters = texels.emitters
        self.sent = self.radiance(self.irradiance, self.direct)
        self.brightest = float(np.percentile(self.irradiance.sum(axis=1), 90))

    def _patches(self, geometry: StaticGeometry, texels: BakedTexels) -> TexelPatches:
        of_map = np.full(self.side * self.side, -1, np.int32)
        of_map[texels.places] = texels.of_texel
        chosen = texels.chosen
        looks = [_look(material) for material in geometry.materials]
        albedo = np.array([look[0] for look in looks], np.float32).reshape(-1, 3)
        emission = np.array([look[1] for look in looks], np.float32).reshape(-1, 3)
        material = geometry.material[texels.triangle[chosen]]
        rows, columns = np.divmod(texels.places[chosen], self.side)
        return TexelPatches(
            of_map=of_map.reshape(self.side, self.side),
            of_texel=texels.of_texel,
            places=np.stack([columns, rows], axis=1).astype(np.float32),
            positions=np.ascontiguousarray(self.positions[chosen]),
            normals=np.ascontiguousarray(self.normals[chosen]),
            owners=np.ascontiguousarray(self.owners[chosen]),
            size=np.bincount(texels.of_texel, minlength=len(chosen)).astype(np.float32),
            albedo=albedo[material],
            emission=emission[material],
            materials=np.asarray(material, np.int32),
        )


@once
def albedo_of_model(model: Model) -> Floats:
    """Return (3,) float32 read-only: the mean share of light that a model's surface gives back."""
    every = triangles_of(model)
    areas = np.bincount(every.part, every.areas_m2, minlength=len(model.parts))
    looks = np.array([_look(part.material)[0] for part in model.parts]).reshape(-1, 3)
    albedo: Floats = (areas @ looks / max(float(areas.sum()), 1e-12)).astype(np.float32)
    albedo.flags.writeable = False
    return albedo


def _as_baked(
    baked: BakedLight, contents: SceneContents, drawn: tuple[DrawnInstance, ...]
) -> WorldSnapshot:
    poses = [baked.charts[one.instance.id].world_from_body for one in drawn]
    still = tuple(replace(one, instance=replace(one.instance, static=True)) for one in drawn)
    return WorldSnapshot(
        sim_time_ns=0,
        step=0,
        contents=replace(contents, instances=still, baked=None),
        world_from_body=np.array(poses).reshape(-1, 4, 4),
        histories=np.zeros(len(drawn), np.int64),
    )


def _look(material: Material) -> tuple[Floats, Floats]:
    """Return the mean albedo and the emission of a material."""
    base = np.asarray(material.base_colour[:3], np.float64)
    texture = material.base_colour_texture
    if texture is not None:
        texels = _some_texels(texture)
        colours = LINEAR_OF_SRGB8[texels[:, :3]]
        weight = texels[:, 3] / 255.0 if material.alpha == "mask" else np.ones(len(texels))
        pattern = weight @ colours / max(float(weight.sum()), 1e-6)
        base = base * pattern
    finish = np.array([[material.roughness, material.metallic]])
    if material.metallic_roughness_texture is not None:
        texels = _some_texels(material.metallic_roughness_texture)
        finish = finish * (np.ones(len(texels)) @ texels[:, 1:3]) / (255.0 * len(texels))
    albedo = returned(base[None], finish[:, :1], finish[:, 1:])[0]
    emission = np.asarray(material.emission, np.float32)
    if texture is not None and emission.any():
        emission = (emission * pattern).astype(np.float32)
    return np.clip(albedo, 0.0, 0.95).astype(np.float32), emission


def _some_texels(texture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return (n, channels): texels evenly over a texture, some 64 rows of them."""
    step = max(texture.shape[0] // 64, 1)
    return texture[::step, ::step].reshape(-1, texture.shape[2])
