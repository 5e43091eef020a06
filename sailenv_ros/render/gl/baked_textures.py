"""Baked light on the GPU: textures of what `baked_state` computes."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.gl.programs import set_uniform
from sailenv_ros.render.scene.baked_state import INSTANCE_ROW, ROW_IDS, BakedState
from sailenv_ros.render.scene.lightmap_compositing import CompositedLight
from sailenv_ros.types.baked_light import SunEdges
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["BakedTextures"]

LIGHT_MAP_UNIT, INSTANCE_UNIT = 4, 5
EDGE_INDEX_UNIT, EDGE_BLOCKS_UNIT = 13, 14
FACTORS_UNIT = 16

BLOCKS_IN_A_ROW = 128
"""Blocks in a row of the texture, as in `lighting.frag`."""

FACTORS_IN_A_ROW = 1024


class BakedTextures:
    """The baked light of the scene that is shown, in one context."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._state = BakedState()
        self._light_map: moderngl.Texture | None = None
        self._instances: moderngl.Texture | None = None
        self._factors: moderngl.Texture | None = None
        self._edge_index: moderngl.Texture | None = None
        self._edge_blocks: moderngl.Texture | None = None
        self._edges: SunEdges | None = None
        self._uploaded: CompositedLight | None = None
        self._table: object = None

    def show(self, snapshot: WorldSnapshot) -> CompositedLight | None:
        """Bring the textures up to date; None where the scene has no baked light."""
        composited = self._state.update(snapshot)
        if composited is None:
            return None
        if composited is not self._uploaded:
            self._upload(composited)
            self._upload_edges(composited.main_edges)
            self._uploaded = composited
        table = self._state.instances
        if table is not self._table:
            self._write(table, self._state.vertex_factors)
        return composited

    def show_alone(self, snapshot: WorldSnapshot, composited: CompositedLight) -> None:
        """Show other light than that of a snapshot, which is that of the last `show`'s scene."""
        self._state.update(snapshot)
        self._upload(composited)
        self._upload_edges(composited.main_edges)
        self._uploaded = composited
        self._write(self._state.around(snapshot, composited.probes), np.zeros(0, np.float32))

    def bind(self, program: moderngl.Program) -> None:
        """Make the textures readable for a program."""
        assert self._light_map is not None
        assert self._instances is not None
        self._light_map.use(LIGHT_MAP_UNIT)
        set_uniform(program, "light_map", LIGHT_MAP_UNIT)
        self._instances.use(INSTANCE_UNIT)
        set_uniform(program, "instance_light", INSTANCE_UNIT)
        assert self._factors is not None
        self._factors.use(FACTORS_UNIT)
        set_uniform(program, "vertex_factors", FACTORS_UNIT)
        assert self._edge_index is not None
        assert self._edge_blocks is not None
        self._edge_index.use(EDGE_INDEX_UNIT)
        set_uniform(program, "edge_index", EDGE_INDEX_UNIT)
        self._edge_blocks.use(EDGE_BLOCKS_UNIT)
        set_uniform(program, "edge_blocks", EDGE_BLOCKS_UNIT)

    def close(self) -> None:
        """Free the textures."""
        of_instances = self._instances, self._factors
        for texture in (self._light_map, *of_instances, self._edge_index, self._edge_blocks):
            if texture is not None:
                texture.release()

    def _write(self, table: NDArray[np.float32], factors: NDArray[np.float32]) -> None:
        # Four numbers a texel: an instance's lie side by side, ROW_IDS instances in a row.
        size = INSTANCE_ROW // 4 * ROW_IDS, len(table) // ROW_IDS
        self._instances = self._numbers(self._instances, size, 4)
        self._instances.write(np.ascontiguousarray(table))
        rows = max(-(-len(factors) // FACTORS_IN_A_ROW), 1)
        padded = np.zeros(rows * FACTORS_IN_A_ROW, np.float32)
        padded[: len(factors)] = factors
        self._factors = self._numbers(self._factors, (FACTORS_IN_A_ROW, rows), 1)
        self._factors.write(padded)
        self._table = table

    def _numbers(
        self, held: moderngl.Texture | None, size: tuple[int, int], components: int
    ) -> moderngl.Texture:
        """Return a texture of numbers of that size: the one that is held, or another."""
        if held is not None and held.size == size:
            return held
        if held is not None:
            held.release()
        made = self._context.texture(size, components, dtype="f4")
        made.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return made

    def _upload_edges(self, edges: SunEdges | None) -> None:
        """Lay the blocks out side by side; without any, one texel says so."""
        if self._edge_index is not None and edges is self._edges:
            return
        index = np.full((1, 1), -1, np.int32) if edges is None else edges.index
        blocks = np.zeros((0, 6, 6), np.uint8) if edges is None else edges.blocks
        rows = max(-(-len(blocks) // BLOCKS_IN_A_ROW), 1)
        padded = np.zeros((rows * BLOCKS_IN_A_ROW, 6, 6), np.uint8)
        padded[: len(blocks)] = blocks
        sheet = padded.reshape(rows, BLOCKS_IN_A_ROW, 6, 6).transpose(0, 2, 1, 3)
        for texture in (self._edge_index, self._edge_blocks):
            if texture is not None:
                texture.release()
        size = index.shape[::-1]
        self._edge_index = self._context.texture(size, 1, np.ascontiguousarray(index), dtype="i4")
        self._edge_blocks = self._context.texture(
            (6 * BLOCKS_IN_A_ROW, 6 * rows), 1, np.ascontiguousarray(sheet), alignment=1
        )
        for texture in (self._edge_index, self._edge_blocks):
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._edges = edges

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
