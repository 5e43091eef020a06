"""Baked light of a world as one picture, and where in it each surface finds its light.

Texels are what a white matt surface would radiate: irradiance / pi. All lights are in them, as
bright as they are now.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.baked_light import BakedLight, LightChart
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Mesh, ModelPart, Texture
from sailenv_ros.world.world import World

__all__ = ["ExportedLight", "LitParts", "light_of"]

BRIGHTEST = 99.9
"""Per cent of the texels that are not brighter than the picture's white."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ExportedLight:
    """The light map of a scene.

    Attributes
    ----------
    texture : (H, W, 4) uint8
        sRGB; opaque.
    white : float
        Radiance of a matt white surface where the picture is white [W/(m² sr)].
    charts : mapping of int to LightChart
        Of the instances that stand where they were baked.
    """

    texture: Texture
    white: float
    charts: Mapping[int, LightChart]


def light_of(world: World) -> ExportedLight:
    """Return the light map of a world.

    Raises
    ------
    InvalidRequest
        If its light is not baked.
    """
    snapshot = world.snapshot()
    contents = snapshot.contents
    if contents.baked is None:
        raise InvalidRequest("light", "baked", "lamps, as the light of this scene is not baked")
    total = _sum(contents.baked, contents.lights)
    white = float(np.percentile(total.max(axis=-1), BRIGHTEST)) or 1.0
    texture = np.full((*total.shape[:2], 4), 255, np.uint8)
    texture[..., :3] = np.rint(255.0 * srgb_from_linear((total / white).clip(0.0, 1.0)))
    texture.flags.writeable = False
    placed = zip(contents.instances, snapshot.world_from_body, strict=True)
    now = {drawn.instance.id: pose for drawn, pose in placed}
    charts = {
        id_: chart
        for id_, chart in contents.baked.charts.items()
        if id_ in now and np.allclose(now[id_], chart.world_from_body, atol=1e-6)
    }
    return ExportedLight(texture=texture, white=white, charts=charts)


def _sum(baked: BakedLight, lights: Sequence[Light]) -> NDArray[np.float64]:
    """Return (H, W, 3): all layers, each as bright as its light is now."""
    power = {light.name: light.intensity * np.asarray(light.colour, np.float64) for light in lights}
    total = np.zeros((*baked.layers[0].direct.shape, 3))
    for layer in baked.layers:
        own = np.ones(3) if layer.light is None else power.get(layer.light.name, np.zeros(3))
        total += own * (layer.direct[..., None].astype(np.float64) + layer.bounced)
    return total


class LitParts:
    """Parts as their charts unwrap them; the same part by the same chart is the same object.

    Parameters
    ----------
    light : ExportedLight
    """

    def __init__(self, light: ExportedLight) -> None:
        self._light = light
        self._meshes: dict[tuple[int, int], Mesh] = {}

    def of(
        self, id_: int, parts: Sequence[ModelPart]
    ) -> tuple[tuple[ModelPart, ...], tuple[NDArray[np.float32], ...]]:
        """Return an instance's parts, and (V, 2) where each vertex is in the light map.

        v grows with rows. What has no chart keeps its parts, and gets no places.
        """
        chart = self._light.charts.get(id_)
        if chart is None:
            return tuple(parts), ()
        found, places = [], []
        for place, part in enumerate(parts):
            key = id(part.mesh), id(chart.unwrapping.vertices[place])
            if key not in self._meshes:
                used = chart.unwrapping.vertices[place]
                self._meshes[key] = Mesh(
                    positions=part.mesh.positions[used],
                    normals=part.mesh.normals[used],
                    uvs=part.mesh.uvs[used],
                    triangles=chart.unwrapping.triangles[place],
                )
            found.append(dataclasses.replace(part, mesh=self._meshes[key]))
            uvs = chart.unwrapping.uvs[place]
            places.append((np.asarray(chart.offset) + chart.scale * uvs).astype(np.float32))
        return tuple(found), tuple(places)
