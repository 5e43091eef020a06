"""From what a surface is (colour, height, roughness) to the textures of a `Material`.

`SurfaceMaps` of float arrays in, a `Surface` out. Knows no particular surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.system.array_cache import Arrays
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.model import Material, Texture

__all__ = ["Floats", "Surface", "SurfaceMaps", "surface_arrays", "surface_of"]

Floats = NDArray[np.float32]

_STEPS = 4096
"""Linear colours are distinguished so finely before they are encoded."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class SurfaceMaps:
    """A square of a surface, all of whose arrays continue at the opposite edge.

    Attributes
    ----------
    albedo : (H, W, 3) float32
        Linear colour, 0 to 1; row 0 is the top.
    height_m : (H, W) float32
        Height above the plane [m].
    roughness : (H, W) float32
        0 to 1.
    tile_m : (2,) tuple of float
        Width and height of what the arrays show [m].
    turn_deg : float
        By which it is laid, counter-clockwise, against the axes of wall or floor [deg].
    """

    albedo: Floats
    height_m: Floats
    roughness: Floats
    tile_m: tuple[float, float]
    turn_deg: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Surface:
    """A material that tiles, and the size at which it is true.

    Attributes
    ----------
    material : Material
        With colour, metallic-roughness and normal texture.
    tile_m : (2,) tuple of float
        Width and height of what the textures show [m].
    turn_deg : float
        By which it is laid, counter-clockwise, against the axes of wall or floor [deg].
    """

    material: Material
    tile_m: tuple[float, float]
    turn_deg: float = 0.0

    def uvs(self, places_m: ArrayLike) -> Floats:
        """Return texture coordinates of places on the surface.

        Parameters
        ----------
        places_m : (N, 2) array
            To the right and up, as seen from the front [m].

        Returns
        -------
        uvs : (N, 2) float32
        """
        places = np.asarray(places_m, dtype=np.float64)
        angle = np.radians(self.turn_deg)
        cosine, sine = np.cos(angle), np.sin(angle)
        turned = places @ np.array([[cosine, -sine], [sine, cosine]])
        uvs: Floats = (turned / self.tile_m).astype(np.float32)
        return uvs


def surface_arrays(maps: SurfaceMaps) -> Arrays:
    """Encode the maps as textures, and what else `surface_of` needs."""
    finish = np.zeros((*maps.roughness.shape, 4), dtype=np.uint8)
    finish[..., 1] = _bytes(maps.roughness)
    finish[..., 3] = 255
    return {
        "colour": _srgb(maps.albedo),
        "finish": finish,
        "normals": _normals(maps.height_m, maps.tile_m),
        "laid": np.array([*maps.tile_m, maps.turn_deg], dtype=np.float64),
    }


def surface_of(name: str, arrays: Arrays) -> Surface:
    """Return the surface whose `surface_arrays` these are."""
    for array in arrays.values():
        array.flags.writeable = False
    width_m, height_m, turn_deg = arrays["laid"].tolist()
    material = Material(
        name=name,
        base_colour=(1.0, 1.0, 1.0, 1.0),
        metallic=0.0,
        roughness=1.0,
        base_colour_texture=arrays["colour"],
        metallic_roughness_texture=arrays["finish"],
        normal_texture=arrays["normals"],
    )
    return Surface(material=material, tile_m=(width_m, height_m), turn_deg=turn_deg)


def _bytes(values: Floats) -> NDArray[np.uint8]:
    scaled = np.clip(values, 0.0, 1.0) * np.float32(255.0) + np.float32(0.5)
    return scaled.astype(np.uint8)


def _srgb(albedo: Floats) -> Texture:
    """Encode linear colours (IEC 61966-2-1) by a table; alpha is 255."""
    table = np.round(255.0 * srgb_from_linear(np.linspace(0.0, 1.0, _STEPS))).astype(np.uint8)
    steps = (np.clip(albedo, 0.0, 1.0) * np.float32(_STEPS - 1) + np.float32(0.5)).astype(np.uint16)
    texture = np.full((*albedo.shape[:2], 4), 255, dtype=np.uint8)
    texture[..., :3] = table[steps]
    return texture


def _normals(height_m: Floats, tile_m: tuple[float, float]) -> Texture:
    """Encode the slopes as normals, x to the right and y up, 128 = 0 (glTF 2.0)."""
    rows, columns = height_m.shape
    step_x, step_y = 2.0 * tile_m[0] / columns, 2.0 * tile_m[1] / rows
    # Neighbours across an edge are those at the opposite edge; rows run downwards.
    x = (np.roll(height_m, 1, axis=1) - np.roll(height_m, -1, axis=1)) / np.float32(step_x)
    y = (np.roll(height_m, -1, axis=0) - np.roll(height_m, 1, axis=0)) / np.float32(step_y)
    scale = np.float32(127.0) / np.sqrt(x * x + y * y + np.float32(1.0))
    texture = np.full((rows, columns, 4), 255, dtype=np.uint8)
    for channel, part in enumerate((x * scale, y * scale, scale)):
        texture[..., channel] = np.round(part + np.float32(128.0)).astype(np.uint8)
    return texture
