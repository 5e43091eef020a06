"""The geometry pass: one walk over all triangles that leaves every pixel's surface.

A `DrawList` with its matrices in place comes in; textures with depth and instance id, and for
pictures normal and material, go out. Only the attachments that are asked for exist in the pass.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from sailenv_ros.render.gl.baked_textures import BakedTextures
from sailenv_ros.render.gl.draw_list import ROWS, Batch, DrawList
from sailenv_ros.render.gl.geometry_buffers import GeometryBuffers
from sailenv_ros.render.gl.materials import BatchKind, MaterialBuffers
from sailenv_ros.render.gl.programs import ProgramCache, set_lens, shader_source
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.views import views_of

__all__ = ["GeometryPass", "Targets", "written_views"]

GL_DEPTH_CLAMP = 0x864F
GL_CLIP_DISTANCE0 = 0x3000

_VERTEX_FORMAT = {"in_position": "3f", "in_normal": "3f", "in_uv": "2f", "in_light_uv": "2f"}
_PADDING = {"in_position": "3x4", "in_normal": "3x4", "in_uv": "2x4", "in_light_uv": "2x4"}
_SIDES = (("front", (0.0, 8.0)), ("back", (0.0, 0.0)))
"""Sides to cull, and by how much the others lie farther off: of two sheets back to back the one
that faces the eye is seen, as natively."""


def written_views() -> tuple[str, ...]:
    """Return the views of source 'geometry' that the pass can write: its shader has an output."""
    outputs = re.findall(r"location = OUT_(\w+)", shader_source("geometry.frag"))
    return tuple(view for view in views_of("geometry") if view.upper() in outputs)


@dataclass(frozen=True, slots=True)
class Targets:
    """The textures of one picture size.

    Attributes
    ----------
    surface : Texture
        Depth along the optical axis [m] and instance id, 2 x float32.
    shape, albedo, light_at : Texture or None
        Normal, roughness, metallic; square root of albedo, emission; place in the light map.
    outputs : dict of str to Texture
        Views that are written as they are, 4 x float32; the fourth is 0 where nothing was hit.
    framebuffer : Framebuffer
        What the geometry pass draws into.
    picture : Framebuffer or None
        What the lighting pass draws into, on the same depth buffer; see `tone_map`.
    """

    surface: moderngl.Texture
    shape: moderngl.Texture | None
    albedo: moderngl.Texture | None
    light_at: moderngl.Texture | None
    outputs: Mapping[str, moderngl.Texture]
    depth: moderngl.Renderbuffer
    framebuffer: moderngl.Framebuffer
    picture: moderngl.Framebuffer | None

    def close(self) -> None:
        """Free the textures."""
        self.framebuffer.release()
        if self.picture is not None:
            texture = self.picture.color_attachments[0]
            self.picture.release()
            texture.release()
        for attached in (
            self.surface,
            self.shape,
            self.albedo,
            self.light_at,
            *self.outputs.values(),
            self.depth,
        ):
            if attached is not None:
                attached.release()


class GeometryPass:
    """Draws surfaces into targets."""

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._programs = programs
        self._index_buffer = context.buffer(reserve=4)

    def close(self) -> None:
        """Free the buffer of indices."""
        self._index_buffer.release()

    def make_targets(
        self,
        width: int,
        height: int,
        *,
        shaded: bool,
        outputs: Sequence[str] = (),
        baked: bool = False,
    ) -> Targets:
        """Make the textures of a picture size.

        Parameters
        ----------
        shaded : bool
            True if a picture is wanted.
        outputs : sequence of str
            Views of `written_views` that are wanted.
        baked : bool
            True to leave places in a light map.
        """
        size = (width, height)
        surface = self._context.texture(size, 2, dtype="f4")
        shape = self._context.texture(size, 4, dtype="f2") if shaded else None
        albedo = self._context.texture(size, 4) if shaded else None
        light_at = self._context.texture(size, 2, dtype="f4") if shaded and baked else None
        written = {view: self._context.texture(size, 4, dtype="f4") for view in outputs}
        textures = (surface, shape, albedo, light_at)
        for texture in (*textures, *written.values()):
            if texture is not None:
                texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        depth = self._context.depth_renderbuffer(size)
        attached = [texture for texture in textures if texture is not None]
        attached += written.values()
        framebuffer = self._context.framebuffer(attached, depth)
        picture = None
        if shaded:
            colour = self._context.texture(size, 4, dtype="f2")
            picture = self._context.framebuffer([colour], depth)
        return Targets(*textures, written, depth, framebuffer, picture)

    def draw(
        self,
        targets: Targets,
        draws: DrawList,
        geometry: GeometryBuffers,
        materials: MaterialBuffers,
        intrinsics: CameraIntrinsics,
        *,
        baked: BakedTextures,
        half_pixels: bool = False,
    ) -> None:
        """Draw everything; `draws` must have been placed for the camera.

        Parameters
        ----------
        baked : BakedTextures
            Read where the targets take places in a light map.
        half_pixels : bool
            True if the lens is that of samples half a pixel apart, see `half_pixels`: textures
            are those of the pixels.
        """
        context = self._context
        targets.framebuffer.use()
        # Nothing hit: infinitely far, instance 0. The other attachments are not read there.
        targets.framebuffer.clear(float("inf"), 0.0, 0.0, 0.0, depth=1.0)
        context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        context.enable_direct(GL_DEPTH_CLAMP)
        context.enable_direct(GL_CLIP_DISTANCE0)
        # The projection turns the picture upside down, so that row 0 of OpenGL's window is the
        # picture's top row and no array is ever flipped; front faces turn the other way with it.
        context.front_face = "cw"
        lies = self._choose(draws, targets)
        try:
            for batch in draws.batches:
                if not any(lies[part][1] for part in batch.chosen):
                    continue
                program = self._program(batch.kind, targets, half_pixels)
                set_lens(program, intrinsics)
                materials.bind(program, batch.kind.maps)
                if targets.light_at is not None:
                    baked.bind(program)
                by_corner = _by_corner(batch.kind, targets)
                indices = self._index_buffer
                for culled, offset in _SIDES if batch.kind.double_sided else _SIDES[1:]:
                    context.cull_face, context.polygon_offset = culled, offset
                    array = bound(context, program, geometry, indices, by_corner=by_corner)
                    issue(program, array, draws, batch, lies)
        finally:
            context.cull_face, context.polygon_offset = "back", (0.0, 0.0)
            context.disable_direct(GL_CLIP_DISTANCE0)
            context.disable_direct(GL_DEPTH_CLAMP)
            context.front_face = "ccw"

    def _choose(self, draws: DrawList, targets: Targets) -> list[tuple[int, int]]:
        """Upload the indices of what may be seen; say where each part's lie."""
        seen, lies = draws.seen_indices(lambda kind: _by_corner(kind, targets))
        if seen.nbytes > self._index_buffer.size:
            self._index_buffer.release()
            self._index_buffer = self._context.buffer(reserve=2 * seen.nbytes, dynamic=True)
        if seen.nbytes:
            self._index_buffer.write(seen)
        return lies

    def _program(self, kind: BatchKind, targets: Targets, half_pixels: bool) -> moderngl.Program:
        switches: dict[str, int] = {}
        shaded = targets.shape is not None
        if not _by_corner(kind, targets):
            switches["SHADED"] = 1
            if half_pixels:
                switches["HALF_PIXELS"] = 1
            if kind.masked:
                switches["MASKED"] = 1
            there = {"COLOUR_MAP": kind.maps[0] >= 0}
            if shaded or "metallic_roughness" in targets.outputs:
                there["FINISH_MAP"] = kind.finish
            if shaded:
                there["NORMAL_MAP"] = kind.relief
            switches.update((name, 1) for name, is_there in there.items() if is_there)
        baked = targets.light_at is not None
        if baked:
            switches["BAKED"] = 1
        first = (4 if baked else 3) if shaded else 1
        for location, view in enumerate(targets.outputs, first):
            switches[f"OUT_{view.upper()}"] = location
        if "SHADED" in switches and not shaded:
            switches["UNLIT"] = 1
        return self._programs.get("geometry.vert", "geometry.frag", ROWS=ROWS, **switches)


def _by_corner(kind: BatchKind, targets: Targets) -> bool:
    """Return whether nothing is read of a kind's vertices but their positions."""
    # Masked materials need their alpha even where no picture is made.
    return targets.shape is None and not targets.outputs and not kind.masked


def bound(
    context: moderngl.Context,
    program: moderngl.Program,
    geometry: GeometryBuffers,
    index_buffer: moderngl.Buffer,
    *,
    by_corner: bool = False,
) -> moderngl.VertexArray:
    """Bind the vertices that a program reads, and indices, for `issue`.

    Parameters
    ----------
    by_corner : bool
        True if the indices are of corners; the program reads positions alone.
    """
    if by_corner:
        return context.vertex_array(
            program,
            [(geometry.corner_buffer, "3f", "in_position")],
            index_buffer=index_buffer,
            index_element_size=4,
        )
    formats, names = [], []
    for name in _VERTEX_FORMAT:
        used = name in program
        formats.append(_VERTEX_FORMAT[name] if used else _PADDING[name])
        names += [name] if used else []
    return context.vertex_array(
        program,
        [(geometry.vertex_buffer, " ".join(formats), *names)],
        index_buffer=index_buffer,
        index_element_size=4,
    )


def issue(
    program: moderngl.Program,
    array: moderngl.VertexArray,
    draws: DrawList,
    batch: Batch,
    lies: Sequence[tuple[int, int]],
) -> None:
    """Draw a batch with a program of `draw.glsl`; `array` is released.

    Parameters
    ----------
    lies : sequence of (int, int)
        First index and number of indices of each part.
    """
    block = program["draw"]
    assert isinstance(block, moderngl.Uniform)
    # The compiler cuts off the vectors that a program does not read.
    uniforms = np.ascontiguousarray(draws.uniforms[:, : block.array_length])
    try:
        for part in batch.chosen:
            first, count = lies[part]
            if count:
                block.write(uniforms[part])
                array.render(moderngl.TRIANGLES, vertices=count, first=first)
    finally:
        array.release()
