"""Materials on the GPU: one row of a storage buffer each.

Materials come in, row numbers go out. Their textures are `textures.TextureArrays`' matter.
"""

from __future__ import annotations

from collections.abc import Iterable

import moderngl
import numpy as np

from sailenv_ros.model import Material, Texture
from sailenv_ros.render.coverage import cutoff_by_level
from sailenv_ros.render.textures import SIZES_PX, TextureArrays, array_of

__all__ = ["MaterialBuffers"]

ROW = np.dtype(
    [
        ("base_colour", "<f4", 4),
        ("roughness", "<f4"),
        ("metallic", "<f4"),
        ("alpha_cutoff", "<f4"),
        ("emission", "<f4"),
        ("layers", "<i4", 3),
        ("cutoff_by_level", "<f2", 2),
    ]
)

EMISSION_SCALE = 16.0
"""Radiance, in units of the base colour, that the G-buffer's 8 bits can hold."""


class MaterialBuffers:
    """The materials of the scene that is shown, in one context."""

    def __init__(self, context: moderngl.Context, *, software: bool) -> None:
        self._context = context
        self._textures = TextureArrays(context, software=software)
        self._shown: list[Material] = []
        self._row_of: dict[int, int] = {}
        self._buffer = context.buffer(np.zeros(1, ROW).tobytes())

    def show(self, materials: Iterable[Material]) -> None:
        """Make sure that these materials are there; others may be gone afterwards."""
        wanted = list({id(material): material for material in materials}.values())
        if all(id(material) in self._row_of for material in wanted):
            return
        self._textures.show(t for m in wanted for t in _textures(m) if t is not None)
        # The number of an object is unique only while the object lives: it is kept.
        self._shown = wanted
        self._row_of = {id(material): row for row, material in enumerate(wanted)}
        rows = np.zeros(len(wanted), ROW)
        for row, material in zip(rows, wanted, strict=True):
            self._fill(row, material)
        self._buffer.release()
        self._buffer = self._context.buffer(rows.tobytes())

    def row(self, material: Material) -> int:
        """Give the row of a material that is shown."""
        return self._row_of[id(material)]

    def bind(self, program: moderngl.Program, maps: tuple[int, int, int]) -> None:
        """Make rows and the arrays of a kind's maps readable for a program."""
        self._buffer.bind_to_storage_buffer(1)
        self._textures.bind(program, maps)

    def close(self) -> None:
        """Free everything on the GPU."""
        self._textures.close()
        self._buffer.release()

    def _fill(self, row: np.void, material: Material) -> None:
        base = np.asarray(material.base_colour, dtype=np.float64)
        glow = float(max(material.emission))
        if glow > 0.0:
            # The G-buffer holds one colour and one strength: what glows has the glow's colour.
            base[:3] = np.asarray(material.emission) / glow
        row["base_colour"] = base
        row["roughness"], row["metallic"] = material.roughness, material.metallic
        row["alpha_cutoff"] = material.alpha_cutoff
        row["emission"] = min(1.0, glow / EMISSION_SCALE)
        row["layers"] = [self._textures.layer(texture) for texture in _textures(material)]
        edge = SIZES_PX[array_of(material.base_colour_texture)]
        row["cutoff_by_level"] = cutoff_by_level(material, edge)


def _textures(material: Material) -> tuple[Texture | None, Texture | None, Texture | None]:
    return (
        material.base_colour_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
    )
