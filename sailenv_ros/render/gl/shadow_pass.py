"""A shadow map of the main directional light: depth as the light sees some of the scene.

A snapshot, a light and the choice of what casts come in; a depth texture and the matrix into it go
out. When and what is drawn is `shadow_plan`'s matter.
"""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.gl.draw_list import ROWS, DrawList
from sailenv_ros.render.gl.geometry_buffers import GeometryBuffers
from sailenv_ros.render.gl.geometry_pass import bound, issue
from sailenv_ros.render.gl.programs import ProgramCache
from sailenv_ros.render.scene.shadow_plan import SIZE_PX, ShadowPlan
from sailenv_ros.types.lights import Light
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["ShadowPass"]


class ShadowPass:
    """The shadow map of one renderer."""

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._program = programs.get("shadow.vert", "shadow.frag", ROWS=ROWS)
        self.texture = context.depth_texture((SIZE_PX, SIZE_PX))
        self.texture.compare_func = "<="
        self.texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._framebuffer = _with_colour(context, self.texture)
        self._resting = _with_colour(context, context.depth_texture((SIZE_PX, SIZE_PX)))
        self.plan = ShadowPlan()

    def draw(
        self,
        light: Light,
        snapshot: WorldSnapshot,
        draws: DrawList,
        geometry: GeometryBuffers,
        *,
        casting: NDArray[np.bool_] | None = None,
        framed: NDArray[np.bool_] | None = None,
    ) -> None:
        """Bring the map up to date; leaves the rows of `draws` placed for the light if it drew.

        Parameters
        ----------
        casting, framed : (N,) bool or None
            As `ShadowPlan.update` takes them.
        """
        redraw = self.plan.update(light, snapshot, casting=casting, framed=framed)
        if redraw is None:
            return
        moved = replace(snapshot, world_from_body=redraw.poses)
        draws.place(moved, self.plan.clip_from_light, self.plan.light_from_world)
        if redraw.keep:
            self._context.copy_framebuffer(self._resting, self._framebuffer)
        if redraw.resting is not None:
            self._resting.use()
            if redraw.clear:
                self._resting.clear(depth=1.0)
            self._issue(draws, geometry, redraw.resting)
        if redraw.from_resting:
            self._context.copy_framebuffer(self._framebuffer, self._resting)
        self._framebuffer.use()
        if not redraw.from_resting:
            self._framebuffer.clear(depth=1.0)
        self._issue(draws, geometry, redraw.casters)

    def _issue(
        self, draws: DrawList, geometry: GeometryBuffers, casting: NDArray[np.bool_]
    ) -> None:
        """Draw some casters into the framebuffer in use."""
        draws.choose_casters(casting)
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.polygon_offset = 1.5, 2.0
        if draws.casters.chosen:
            array = bound(
                self._context,
                self._program,
                geometry,
                geometry.corner_index_buffer,
                by_corner=True,
            )
            issue(self._program, array, draws, draws.casters, draws.lies)
        self._context.polygon_offset = 0.0, 0.0

    def close(self) -> None:
        """Free the map."""
        for framebuffer in (self._framebuffer, self._resting):
            attached = (*framebuffer.color_attachments, framebuffer.depth_attachment)
            framebuffer.release()
            for texture in attached:
                texture.release()


def _with_colour(context: moderngl.Context, depth: moderngl.Texture) -> moderngl.Framebuffer:
    """Make a framebuffer for depth; only those that have colours can be copied with moderngl."""
    framebuffer = context.framebuffer([context.renderbuffer((SIZE_PX, SIZE_PX), 1)], depth)
    framebuffer.color_mask = False, False, False, False
    return framebuffer
