"""From surfaces to a picture: lights, sky, tone curve, smoothed edges.

Targets of the geometry pass come in, an 8-bit sRGB picture goes out. Ground truth never passes
through here.
"""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera
from sailenv_ros.lights import Environment, Light
from sailenv_ros.render.geometry_pass import Targets
from sailenv_ros.render.programs import ProgramCache, set_uniform
from sailenv_ros.render.shadow_pass import SIZE_PX, ShadowPass

__all__ = ["MAX_LIGHTS", "LightingPass", "main_light"]

MAX_LIGHTS = 16
"""Lights that are taken into account, the strongest first."""

PENUMBRA_TEXELS = 1.6

_KINDS = {"directional": 0.0, "point": 1.0, "spot": 2.0, "area": 3.0}

ROW = np.dtype(
    [
        ("colour_kind", "<f4", 4),
        ("position_range", "<f4", 4),
        ("direction_inner", "<f4", 4),
        ("outer_shadow", "<f4", 4),
    ]
)


def main_light(lights: Sequence[Light]) -> Light | None:
    """Give the light that casts the shadow map: the strongest directional one."""
    suns = [light for light in lights if light.type == "directional" and light.intensity > 0.0]
    return max(suns, key=_strength, default=None)


class LightingPass:
    """Lights pictures of one size after the other."""

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._light = programs.get("screen.vert", "lighting.frag", MAX_LIGHTS=MAX_LIGHTS)
        self._edges = programs.get("screen.vert", "edges.frag")
        self._light_array = context.vertex_array(self._light, [])
        self._edge_array = context.vertex_array(self._edges, [])
        self._lights = context.buffer(reserve=MAX_LIGHTS * ROW.itemsize, dynamic=True)

    def make_pictures(self, width: int, height: int) -> tuple[moderngl.Framebuffer, moderngl.Framebuffer]:
        """Make the lit and the finished picture of a size."""
        pictures = []
        for _ in range(2):
            texture = self._context.texture((width, height), 4)
            texture.repeat_x = texture.repeat_y = False
            pictures.append(self._context.framebuffer([texture]))
        return pictures[0], pictures[1]

    def draw(
        self,
        targets: Targets,
        lit: moderngl.Framebuffer,
        camera: Camera,
        lights: Sequence[Light],
        environment: Environment,
        shadow: ShadowPass,
    ) -> None:
        """Light the surfaces of `targets` into `lit`."""
        program = self._light
        sun = main_light(lights)
        rows = _light_rows(lights, sun, camera)
        self._lights.write(rows.tobytes())
        self._lights.bind_to_uniform_block(0)
        intrinsics = camera.intrinsics
        exposure = 2.0**environment.exposure
        set_uniform(program, "light_count", min(len(lights), MAX_LIGHTS))
        set_uniform(program, "lens", (intrinsics.fx, intrinsics.cx, intrinsics.cy, exposure))
        rotation = camera.world_from_camera[:3, :3]
        set_uniform(program, "world_from_optical", _columns(rotation))
        set_uniform(program, "shadow_from_optical", _columns(shadow.map_from_world @ camera.world_from_camera))
        set_uniform(program, "shadow_texel", (shadow.texel_m, 1.0 / SIZE_PX, PENUMBRA_TEXELS))
        set_uniform(program, "ambient", environment.ambient)
        for name in ("sky_zenith", "sky_horizon", "sky_ground"):
            set_uniform(program, name, getattr(environment, name))
        plain = 1.0 if environment.background == "colour" else 0.0
        set_uniform(program, "background", (*environment.background_colour, plain))
        assert targets.shape is not None and targets.albedo is not None  # noqa: PT018, S101 - lit targets have both
        for unit, (name, texture) in enumerate(
            (
                ("surface", targets.surface),
                ("shape", targets.shape),
                ("albedo", targets.albedo),
                ("shadow_map", shadow.texture),
            )
        ):
            texture.use(unit)
            set_uniform(program, name, unit)
        self._context.enable_only(moderngl.NOTHING)
        lit.use()
        self._light_array.render(moderngl.TRIANGLES, vertices=3)

    def smooth_edges(self, lit: moderngl.Framebuffer, finished: moderngl.Framebuffer) -> None:
        """Smooth the stair-steps of `lit` into `finished`."""
        texture = lit.color_attachments[0]
        texture.use(0)
        set_uniform(self._edges, "picture", 0)
        set_uniform(self._edges, "texel", (1.0 / lit.width, 1.0 / lit.height))
        self._context.enable_only(moderngl.NOTHING)
        finished.use()
        self._edge_array.render(moderngl.TRIANGLES, vertices=3)

    def close(self) -> None:
        """Free the buffers."""
        for resource in (self._light_array, self._edge_array, self._lights):
            resource.release()


def _strength(light: Light) -> float:
    return light.intensity * max(light.colour)


def _light_rows(lights: Sequence[Light], sun: Light | None, camera: Camera) -> NDArray[np.void]:
    rows = np.zeros(MAX_LIGHTS, ROW)
    strongest = sorted(lights, key=_strength, reverse=True)[:MAX_LIGHTS]
    for row, light in zip(rows, strongest, strict=False):
        power = np.asarray(light.colour) * light.intensity
        if light.type == "area":
            # Seen from afar an area light is a point with the area's radiant intensity.
            power = power * light.width_m * light.height_m
        row["colour_kind"] = [*power, _KINDS[light.type]]
        position = camera.camera_from_world @ [*light.position_m, 1.0]
        row["position_range"] = [*position[:3], max(light.range_m, 1e-3)]
        direction = camera.camera_from_world[:3, :3] @ np.asarray(light.direction)
        row["direction_inner"] = [*direction, np.cos(np.radians(light.inner_cone_deg))]
        outer = np.cos(np.radians(light.outer_cone_deg))
        row["outer_shadow"] = [outer, 1.0 if light is sun else 0.0, 0.0, 0.0]
    return rows


def _columns(matrix: NDArray[np.float64]) -> tuple[float, ...]:
    """Give a matrix in GLSL's order of numbers."""
    return tuple(float(number) for number in matrix.T.reshape(-1))


