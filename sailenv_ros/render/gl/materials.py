"""Materials as the shaders read them: three vectors of uniforms each.

Materials come in, numbers go out. Their textures are `textures.TextureArrays`' matter.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.gl.textures import TextureArrays
from sailenv_ros.render.scene.material_factors import EMISSION_SCALE, material_factors
from sailenv_ros.render.scene.packed_maps import pack_maps
from sailenv_ros.render.scene.texture_images import array_of
from sailenv_ros.types.model import Material, Texture

__all__ = ["BatchKind", "MaterialBuffers"]


@dataclass(frozen=True, slots=True, order=True)
class BatchKind:
    """Properties that materials must share to be drawn by one program.

    Attributes
    ----------
    maps : (2,) tuple of int
        Array that the base colour map and the packed normal-roughness-metallic map (packed map,
        for short) lie in, -1 for no map.
    finish, relief : bool
        True if the packed map holds roughness and metallic; if it holds normals.
    masked : bool
        True if pixels may be dropped by alpha.
    double_sided : bool
        True if back faces are drawn.
    """

    maps: tuple[int, int] = (-1, -1)
    finish: bool = False
    relief: bool = False
    masked: bool = False
    double_sided: bool = False


class MaterialBuffers:
    """The materials of the scene that is shown, in one context."""

    def __init__(self, context: moderngl.Context, *, software: bool) -> None:
        self._textures = TextureArrays(context, software=software)
        self._shown: dict[int, Material] = {}
        self._fine: dict[int, Texture | None] = {}
        self._vectors: dict[int, NDArray[np.float32]] = {}

    def show(self, materials: Iterable[Material]) -> None:
        """Make sure that these materials are there; others may be gone afterwards."""
        # The number of an object is unique only while the object lives: it is kept.
        wanted = {id(material): material for material in materials}
        if wanted.keys() <= self._shown.keys():
            return
        joined: dict[tuple[int, int], Texture | None] = {
            _packed_key(material): self._fine[key] for key, material in self._shown.items()
        }
        for material in wanted.values():
            if _packed_key(material) not in joined:
                joined[_packed_key(material)] = pack_maps(material)
        self._fine = {key: joined[_packed_key(material)] for key, material in wanted.items()}
        self._shown = wanted
        maps = [self._maps(material) for material in wanted.values()]
        self._textures.show(
            (colour for colour, _ in maps if colour is not None),
            (fine for _, fine in maps if fine is not None),
        )
        self._vectors = {key: self._described(material) for key, material in wanted.items()}

    def vectors(self, material: Material) -> NDArray[np.float32]:
        """Return (4, 4) float32: how `draw.glsl` has a material that is shown."""
        return self._vectors[id(material)]

    def lit_vectors(
        self, material: Material, lamp_power: tuple[float, float, float]
    ) -> NDArray[np.float32]:
        """Return the same for a material of a lamp that is on; see `material_factors`."""
        return self._described(material, lamp_power)

    def kind(self, material: Material) -> BatchKind:
        """Classify a material that is shown."""
        colour, fine = (array_of(texture) for texture in self._maps(material))
        return BatchKind(
            maps=(colour, fine),
            finish=material.metallic_roughness_texture is not None,
            relief=material.normal_texture is not None,
            masked=material.alpha == "mask",
            double_sided=material.double_sided,
        )

    def bind(self, program: moderngl.Program, maps: tuple[int, int]) -> None:
        """Make the arrays that a kind's maps lie in readable for a program."""
        self._textures.bind(program, maps)

    def close(self) -> None:
        """Free everything on the GPU."""
        self._textures.close()

    def _described(
        self, material: Material, lamp_power: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> NDArray[np.float32]:
        factors = material_factors(material, lamp_power)
        return np.array(
            [
                [0.0, factors.cutoff_fall, factors.least_cutoff, factors.base[0]],
                [
                    *(self._textures.layer(texture) for texture in self._maps(material)),
                    *factors.base[1:],
                ],
                factors.colour,
                [
                    factors.roughness,
                    factors.metallic,
                    factors.alpha_cutoff,
                    factors.emission / EMISSION_SCALE,
                ],
            ],
            np.float32,
        )

    def _maps(self, material: Material) -> tuple[Texture | None, Texture | None]:
        return material.base_colour_texture, self._fine[id(material)]


def _packed_key(material: Material) -> tuple[int, int]:
    """Return a key that tells joined maps apart while the materials live."""
    return id(material.metallic_roughness_texture), id(material.normal_texture)
