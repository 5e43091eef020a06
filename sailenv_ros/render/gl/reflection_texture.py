"""Reflection maps on the GPU, and what shaders need to look them up."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.gl.programs import set_uniform
from sailenv_ros.render.scene.baked_state import ROW_IDS
from sailenv_ros.render.scene.reflection_map import EDGE, ROUGHNESSES, layers_per_roughness
from sailenv_ros.render.scene.reflection_points import MOST

__all__ = ["ReflectionTexture"]

UNIT, TABLE_UNIT = 6, 15


class ReflectionTexture:
    """The reflection maps of a room, in one context; black until `write`."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture3D | None = None
        self._table: moderngl.Texture | None = None
        self._shown: object = None
        self._box = np.zeros((2, 3))
        self._points = np.zeros((MOST, 3), np.float32)
        self._around = np.zeros((MOST, 4), np.float32)

    def write(
        self,
        layers: NDArray[np.float16],
        around: NDArray[np.float64],
        points: NDArray[np.float64],
        box: NDArray[np.float64],
    ) -> None:
        """Take the maps of `RoomReflections`, and the points and the box of `ReflectionPoints`."""
        size = (EDGE + 2, EDGE + 2, len(layers) * len(ROUGHNESSES))
        if self._texture is None or self._texture.size != size:
            if self._texture is not None:
                self._texture.release()
            self._texture = self._context.texture3d(size, 4, dtype="f2")
            self._texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            self._texture.repeat_x = self._texture.repeat_y = self._texture.repeat_z = False
        self._texture.write(np.ascontiguousarray(layers))
        self._box = box
        self._points[: len(points)], self._around[: len(points)] = points, around

    def write_table(self, table: NDArray[np.int32]) -> None:
        """Take what `ReflectionPoints.table` returned."""
        if table is self._shown:
            return
        rows = len(table) // ROW_IDS
        if self._table is None or self._table.height != rows:
            if self._table is not None:
                self._table.release()
            self._table = self._context.texture((ROW_IDS, rows), 1, dtype="f4")
            self._table.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._table.write(table.astype(np.float32))
        self._shown = table

    def bind(self, program: moderngl.Program) -> None:
        """Make it readable for a program."""
        assert self._texture is not None
        assert self._table is not None
        self._texture.use(UNIT)
        set_uniform(program, "reflections", UNIT)
        self._table.use(TABLE_UNIT)
        set_uniform(program, "reflection_table", TABLE_UNIT)
        for name, value in zip(("room_low", "room_high"), self._box, strict=True):
            set_uniform(program, name, tuple(value))
        set_uniform(program, "reflection_from", self._points)
        set_uniform(program, "room_light", self._around)
        layers, scale = float(len(ROUGHNESSES)), EDGE / (EDGE + 2)
        numbers = (scale, layers_per_roughness(), layers, float(self._texture.depth))
        set_uniform(program, "reflection_texel", numbers)

    def close(self) -> None:
        """Free the textures."""
        for texture in (self._texture, self._table):
            if texture is not None:
                texture.release()
