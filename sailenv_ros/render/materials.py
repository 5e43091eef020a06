"""Materials as the shaders read them: three vectors of uniforms each.

Materials come in, numbers go out. Their textures are `textures.TextureArrays`' matter.
"""

from __future__ import annotations

from collections.abc import Iterable

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.model import Material, Texture
from sailenv_ros.render.coverage import cutoff_by_level
from sailenv_ros.render.textures import SIZES_PX, TextureArrays, array_of

__all__ = ["MaterialBuffers"]

EMISSION_SCALE = 16.0
"""Radiance, in units of the base colour, that the G-buffer's 8 bits can hold."""


class MaterialBuffers:
    """The materials of the scene that is shown, in one context."""

    def __init__(self, context: moderngl.Context, *, software: bool) -> None:
        self._textures = TextureArrays(context, software=software)
        self._shown: dict[int, Material] = {}
        self._vectors: dict[int, NDArray[np.float32]] = {}

    def show(self, materials: Iterable[Material]) -> None:
        """Make sure that these materials are there; others may be gone afterwards."""
        # The number of an object is unique only while the object lives: it is kept.
        wanted = {id(material): material for material in materials}
        if wanted.keys() <= self._shown.keys():
            return
        self._textures.show(t for m in wanted.values() for t in _textures(m) if t is not None)
        self._shown = wanted
        self._vectors = {key: self._described(material) for key, material in wanted.items()}

    def vectors(self, material: Material) -> NDArray[np.float32]:
        """Give (4, 4) float32: how `draw.glsl` has a material that is shown."""
        return self._vectors[id(material)]

    def bind(self, program: moderngl.Program, maps: tuple[int, int, int]) -> None:
        """Make the arrays that a kind's maps lie in readable for a program."""
        self._textures.bind(program, maps)

    def close(self) -> None:
        """Free everything on the GPU."""
        self._textures.close()

    def _described(self, material: Material) -> NDArray[np.float32]:
        base = np.asarray(material.base_colour, dtype=np.float64)
        glow = float(max(material.emission))
        if glow > 0.0:
            # The G-buffer holds one colour and one strength: what glows has the glow's colour.
            base[:3] = np.asarray(material.emission) / glow
        glow = min(1.0, glow / EMISSION_SCALE)
        edge = SIZES_PX[array_of(material.base_colour_texture)]
        return np.array(
            [
                [0.0, *cutoff_by_level(material, edge), 0.0],
                [*(self._textures.layer(texture) for texture in _textures(material)), 0.0],
                base,
                [material.roughness, material.metallic, material.alpha_cutoff, glow],
            ],
            np.float32,
        )


def _textures(material: Material) -> tuple[Texture | None, Texture | None, Texture | None]:
    return (
        material.base_colour_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
    )
