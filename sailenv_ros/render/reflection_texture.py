"""A reflection map on the GPU, and what shaders need to look it up."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.programs import set_uniform
from sailenv_ros.render.reflection_map import (
    EDGE,
    ROUGHNESSES,
    layers_per_roughness,
    light_from_around,
)

__all__ = ["ReflectionTexture"]

UNIT = 6


class ReflectionTexture:
    """A reflection map, in one context; black until `write`."""

    def __init__(self, context: moderngl.Context) -> None:
        size = (EDGE + 2, EDGE + 2, len(ROUGHNESSES))
        self._texture = context.texture3d(size, 4, dtype="f2")
        self._texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self._texture.repeat_x = self._texture.repeat_y = self._texture.repeat_z = False
        self._box = np.zeros((3, 3))
        self._light = np.zeros(4)

    def write(
        self, layers: NDArray[np.float16], position_m: NDArray[np.float64], box: NDArray[np.float64]
    ) -> None:
        """Take the layers of `prefilter`.

        Parameters
        ----------
        position_m : (3,) float64
            From where it was seen.
        box : (2, 3) float64
            Walls of the room; what is mirrored is looked for on them.
        """
        self._texture.write(np.ascontiguousarray(layers))
        self._box = np.stack([position_m, *box])
        self._light = light_from_around(layers[0, 1:-1, 1:-1, :3].astype(np.float64))

    def bind(self, program: moderngl.Program) -> None:
        """Make it readable for a program."""
        self._texture.use(UNIT)
        set_uniform(program, "reflections", UNIT)
        for name, value in zip(
            ("reflection_from", "room_low", "room_high"), self._box, strict=True
        ):
            set_uniform(program, name, tuple(value))
        set_uniform(program, "room_light", tuple(self._light))
        scale = EDGE / (EDGE + 2)
        layers = float(len(ROUGHNESSES))
        set_uniform(program, "reflection_texel", (scale, layers_per_roughness(), layers))

    def close(self) -> None:
        """Free the texture."""
        self._texture.release()
