"""The glass pass: see-through surfaces over the picture of what lies behind them.

A lit picture comes in, the same picture with glass in it goes out. Glass is in the picture alone:
depth, ids, flow and normals are those of what lies behind, and the pass writes none of them. The
most distant part is drawn first; a scene without glass costs nothing.
"""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.gl.draw_list import ROWS, Batch, DrawList
from sailenv_ros.render.gl.geometry_buffers import GeometryBuffers
from sailenv_ros.render.gl.geometry_pass import (
    GL_CLIP_DISTANCE0,
    GL_DEPTH_CLAMP,
    Targets,
    bound,
    issue,
)
from sailenv_ros.render.gl.lighting_pass import Illumination, set_camera
from sailenv_ros.render.gl.materials import MaterialBuffers
from sailenv_ros.render.gl.programs import ProgramCache
from sailenv_ros.render.scene.reflection_points import MOST
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["GlassPass"]

GL_SRC1_COLOR = 0x88F9


class GlassPass:
    """Draws glass, in one context."""

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._programs = programs
        self._contents: SceneContents | None = None
        self._draws: DrawList | None = None

    def show(
        self, contents: SceneContents, geometry: GeometryBuffers, materials: MaterialBuffers
    ) -> None:
        """Make the draws of a scene's contents; they are kept until the contents change.

        `geometry` and `materials` must show the contents.
        """
        if contents is self._contents:
            return
        self.close()
        self._contents = contents
        parts = (part for drawn in contents.instances for part in drawn.model.parts)
        if any(part.material.alpha == "blend" for part in parts):
            self._draws = DrawList(contents, geometry, materials, see_through=True)

    def draw(
        self,
        targets: Targets,
        snapshot: WorldSnapshot,
        camera: Camera,
        clip_from_optical: NDArray[np.float64],
        illumination: Illumination,
        geometry: GeometryBuffers,
        materials: MaterialBuffers,
        *,
        half_pixels: bool = False,
    ) -> None:
        """Draw what `show` was given over the picture of `targets`.

        See `GeometryPass.draw` for `half_pixels`.
        """
        if self._draws is None:
            return
        self._draws.place(snapshot, clip_from_optical, camera.camera_from_world)
        batches = self._draws.farthest_first()
        if not batches:
            return
        assert targets.picture is not None
        context = self._context
        targets.picture.use()
        context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND | moderngl.CULL_FACE)
        context.blend_func = moderngl.ONE, GL_SRC1_COLOR
        # As in the geometry pass: depth must compare with what it left.
        context.enable_direct(GL_DEPTH_CLAMP)
        context.enable_direct(GL_CLIP_DISTANCE0)
        context.front_face = "cw"
        targets.picture.depth_mask = False
        try:
            for batch in batches:
                self._draw(batch, camera, illumination, geometry, materials, half_pixels)
        finally:
            targets.picture.depth_mask = True
            context.cull_face = "back"
            context.front_face = "ccw"
            context.disable_direct(GL_CLIP_DISTANCE0)
            context.disable_direct(GL_DEPTH_CLAMP)
            context.disable(moderngl.BLEND)
            context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA

    def close(self) -> None:
        """Free the buffers."""
        self._draws = self._contents = None

    def _draw(
        self,
        batch: Batch,
        camera: Camera,
        illumination: Illumination,
        geometry: GeometryBuffers,
        materials: MaterialBuffers,
        half_pixels: bool,
    ) -> None:
        assert self._draws is not None
        program = self._program(batch, illumination, half_pixels)
        set_camera(program, camera, illumination.environment)
        materials.bind(program, batch.kind.maps)
        if illumination.baked is not None:
            illumination.baked.bind(program)
        if illumination.reflections is not None:
            illumination.reflections.bind(program)
        # Of a body whose back is drawn, the back lies behind.
        for culled in ("front", "back") if batch.kind.double_sided else ("back",):
            self._context.cull_face = culled
            array = bound(self._context, program, geometry, geometry.index_buffer)
            issue(program, array, self._draws, batch, self._draws.lies)

    def _program(
        self, batch: Batch, illumination: Illumination, half_pixels: bool
    ) -> moderngl.Program:
        switches = {"SHADED": 1}
        if half_pixels:
            switches["HALF_PIXELS"] = 1
        if batch.kind.maps[0] >= 0:
            switches["COLOUR_MAP"] = 1
        if illumination.baked is not None:
            switches["BAKED"] = 1
            if illumination.reflections is not None:
                switches["REFLECTIONS"], switches["REFLECTION_POINTS"] = 1, MOST
        return self._programs.get("geometry.vert", "glass.frag", ROWS=ROWS, **switches)
