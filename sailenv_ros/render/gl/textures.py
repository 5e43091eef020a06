"""Textures on the GPU: arrays of layers, one array for each of three sizes.

The textures of a scene come in, arrays and layers to look them up by go out. Each texture is
brought to the next size that holds it, with mip-maps. What the present
scene does not show gives way to what it does, so memory is bounded by the largest scene.
"""

from __future__ import annotations

from collections.abc import Iterable

import moderngl

from sailenv_ros.render.gl.programs import set_uniform
from sailenv_ros.render.scene.texture_images import SIZES_PX, array_of, square_texels
from sailenv_ros.types.model import Texture

__all__ = ["TextureArrays"]

_SOFTWARE_FILTERS = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR_MIPMAP_NEAREST)
"""Filters of colour and packed maps on the CPU: roughness and relief may change abruptly between
levels."""

SPARE = 0.25
"""Share of layers that a new array has in reserve, for what is spawned later."""

_UNIFORMS = ("colour_maps", "packed_maps")
_FIRST_TEXTURE_UNIT = 8


class TextureArrays:
    """All textures of one context.

    Parameters
    ----------
    context : moderngl.Context
    software : bool
        True if the CPU draws.
    """

    def __init__(self, context: moderngl.Context, *, software: bool) -> None:
        self._arrays = tuple(_Layers(context, edge) for edge in SIZES_PX)
        self._samplers = tuple(
            context.sampler(
                filter=(smaller if software else moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
            )
            for smaller in _SOFTWARE_FILTERS
        )

    def show(self, colours: Iterable[Texture], fine: Iterable[Texture]) -> None:
        """Make sure that these are there; others may be gone afterwards.

        Parameters
        ----------
        colours : iterable of Texture
            sRGB; the arrays hold the square root of linear colour (see `geometry.frag`).
        fine : iterable of Texture
            Held as they are.
        """
        coded = {id(texture): (texture, True) for texture in colours}
        plain = {id(texture): (texture, False) for texture in fine}
        by_size: list[list[tuple[Texture, bool]]] = [[] for _ in SIZES_PX]
        for texture, is_colour in (plain | coded).values():
            by_size[array_of(texture)].append((texture, is_colour))
        for array, wanted in zip(self._arrays, by_size, strict=True):
            array.show(wanted)

    def layer(self, texture: Texture | None) -> int:
        """Return the layer of a texture that is there; 0 for none."""
        return 0 if texture is None else self._arrays[array_of(texture)].layer(texture)

    def bind(self, program: moderngl.Program, maps: tuple[int, int]) -> None:
        """Make the arrays that a kind's maps lie in readable for a program."""
        for unit, (name, array) in enumerate(zip(_UNIFORMS, maps, strict=True)):
            if array >= 0:
                self._arrays[array].use(_FIRST_TEXTURE_UNIT + unit)
                self._samplers[unit].use(_FIRST_TEXTURE_UNIT + unit)
                set_uniform(program, name, _FIRST_TEXTURE_UNIT + unit)

    def close(self) -> None:
        """Free everything on the GPU."""
        for array in self._arrays:
            array.close()
        for sampler in self._samplers:
            sampler.release()


class _Layers:
    """One array of square textures; a texture keeps its layer while it is shown."""

    def __init__(self, context: moderngl.Context, edge: int) -> None:
        self._context = context
        self._edge = edge
        self._textures: list[Texture | None] = []
        self._layer_of: dict[int, int] = {}
        self._array = context.texture_array((1, 1, 1), 4)

    def layer(self, texture: Texture) -> int:
        return self._layer_of[id(texture)]

    def use(self, unit: int) -> None:
        self._array.use(unit)

    def close(self) -> None:
        self._array.release()

    def show(self, wanted: list[tuple[Texture, bool]]) -> None:
        """Bring in what is not there yet: over what is no longer wanted, or into a new array."""
        new = [entry for entry in wanted if id(entry[0]) not in self._layer_of]
        roomy = len(self._textures) > 2 * (len(wanted) + 4)
        if not new and not roomy:
            return
        if roomy or len(wanted) > len(self._textures):
            self._make(len(wanted))
            new = wanted
        kept = {id(texture) for texture, _ in wanted}
        free = (
            layer
            for layer, texture in enumerate(self._textures)
            if texture is None or id(texture) not in kept
        )
        for layer, (texture, is_colour) in zip(list(free), new, strict=False):
            self._put(layer, texture, is_colour)
        if new:
            self._array.build_mipmaps()

    def _make(self, count: int) -> None:
        """Begin again with room for so many textures, and some."""
        self._array.release()
        layers = count + int(SPARE * count) if count else 0
        edge = self._edge if layers else 1
        self._array = self._context.texture_array((edge, edge, max(1, layers)), 4)
        self._textures = [None] * layers
        self._layer_of = {}

    def _put(self, layer: int, texture: Texture, is_colour: bool) -> None:
        old = self._textures[layer]
        if old is not None:
            del self._layer_of[id(old)]
        # The number of an object is unique only while the object lives: it is kept.
        self._textures[layer] = texture
        self._layer_of[id(texture)] = layer
        pixels = square_texels(texture, self._edge, is_colour=is_colour)
        self._array.write(pixels, viewport=(0, 0, layer, self._edge, self._edge, 1))
