"""Baked light on the GPU: textures of what `baked_state` works out."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.baked_state import ROW_IDS, BakedState
from sailenv_ros.render.lightmap_compositing import CompositedLight
from sailenv_ros.render.programs import set_uniform
from sailenv_ros.snapshot import WorldSnapshot

__all__ = ["BakedTextures"]

LIGHT_MAP_UNIT, INSTANCE_UNIT = 4, 5


class BakedTextures:
    """The baked light of the scene that is shown, in one context."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._state = BakedState()
        self._light_map: moderngl.Texture | None = None
        self._instances: moderngl.Texture | None = None
        self._uploaded: CompositedLight | None = None
        self._table: object = None

    def show(self, snapshot: WorldSnapshot) -> CompositedLight | None:
        """Bring the textures up to date; None where the scene has no baked light."""
        composited = self._state.update(snapshot)
        if composited is None:
            return None
        if composited is not self._uploaded:
            self._upload(composited)
            self._uploaded = composited
        table = self._state.instances
        if table is not self._table:
            self._write(table)
        return composited

    def show_alone(self, snapshot: WorldSnapshot, composited: CompositedLight) -> None:
        """Show other light than that of a snapshot, which is that of the last `show`'s scene."""
        self._state.update(snapshot)
        self._upload(composited)
        self._uploaded = composited
        self._write(self._state.around(snapshot, composited.probes))

    def bind(self, program: moderngl.Program) -> None:
        """Make the textures readable for a program."""
        assert self._light_map is not None
        assert self._instances is not None
        self._light_map.use(LIGHT_MAP_UNIT)
        set_uniform(program, "light_map", LIGHT_MAP_UNIT)
        self._instances.use(INSTANCE_UNIT)
        set_uniform(program, "instance_light", INSTANCE_UNIT)

    def close(self) -> None:
        """Free the textures."""
        for texture in (self._light_map, self._instances):
            if texture is not None:
                texture.release()

    def _write(self, table: NDArray[np.float32]) -> None:
        # Red, green and blue of an instance lie side by side, ROW_IDS instances in a row.
        rows = len(table) // ROW_IDS
        if self._instances is None or self._instances.height != rows:
            if self._instances is not None:
                self._instances.release()
            self._instances = self._context.texture((3 * ROW_IDS, rows), 4, dtype="f4")
            self._instances.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._instances.write(np.ascontiguousarray(table))
        self._table = table

    def _upload(self, composited: CompositedLight) -> None:
        texels = composited.texels()
        height, width, _ = texels.shape
        if self._light_map is None or self._light_map.size != (width, height):
            if self._light_map is not None:
                self._light_map.release()
            self._light_map = self._context.texture((width, height), 4, dtype="f2")
            self._light_map.filter = (moderngl.LINEAR, moderngl.LINEAR)
            self._light_map.repeat_x = self._light_map.repeat_y = False
        self._light_map.write(np.ascontiguousarray(texels))
