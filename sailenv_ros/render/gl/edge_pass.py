"""The edge pass: from samples half a pixel apart to pixels with smooth edges.

Lit targets of a `Camera.of_half_pixels` come in, the picture of its pixels goes out.
"""

from __future__ import annotations

import moderngl

from sailenv_ros.render.gl.geometry_pass import Targets
from sailenv_ros.render.gl.programs import ProgramCache, set_uniform

__all__ = ["EdgePass"]


class EdgePass:
    """Smooths the edges of pictures, in one context."""

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._programs = programs
        self._array: moderngl.VertexArray | None = None

    def draw(self, samples: Targets, picture: moderngl.Framebuffer) -> None:
        """Draw the pixels of lit samples.

        Parameters
        ----------
        samples : Targets
            (2 H + 1, 2 W + 1), lit.
        picture : Framebuffer
            (H, W), 4 x float16: takes radiance and share.
        """
        assert samples.shape is not None
        assert samples.picture is not None
        program = self._programs.get("screen.vert", "edges.frag")
        if self._array is None:
            self._array = self._context.vertex_array(program, [])
        lit = samples.picture.color_attachments[0]
        assert isinstance(lit, moderngl.Texture)
        textures = {"surface": samples.surface, "shape": samples.shape, "picture": lit}
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            set_uniform(program, name, unit)
        picture.use()
        self._context.enable_only(moderngl.NOTHING)
        self._array.render(moderngl.TRIANGLES, vertices=3)

    def close(self) -> None:
        """Free what is drawn with."""
        if self._array is not None:
            self._array.release()
            self._array = None
