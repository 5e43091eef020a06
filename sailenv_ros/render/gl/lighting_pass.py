"""From surfaces to radiance: lights and sky.

Targets of the geometry pass come in, a half-precision picture of radiance goes out. Ground truth
never passes through here.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lamp import LAMP
from sailenv_ros.render.gl.baked_textures import BakedTextures
from sailenv_ros.render.gl.geometry_pass import Targets
from sailenv_ros.render.gl.programs import ProgramCache, set_lens, set_uniform
from sailenv_ros.render.gl.reflection_texture import ReflectionTexture
from sailenv_ros.render.gl.shadow_pass import ShadowPass
from sailenv_ros.render.scene.lamps import MAX_LIGHTS, strongest_lamps
from sailenv_ros.render.scene.outside_light import NOTHING_OUTSIDE
from sailenv_ros.render.scene.reflection_points import MOST
from sailenv_ros.render.scene.seen_sky import seen_exposure, seen_sky
from sailenv_ros.render.scene.shadow_plan import SIZE_PX
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.lights import Environment, Light, SkyMap, lamp_rows

__all__ = ["Illumination", "LightingPass", "set_camera"]

_log = logging.getLogger(__name__)

PENUMBRA_TEXELS = 1.6

SKY_UNIT = 7
"""Texture unit of the sky's picture, below those of materials."""

LIGHT_AT_UNIT, STATIC_SHADOW_UNIT = 11, 12
"""Texture units beyond those of materials."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Illumination:
    """Everything that lights a picture.

    Attributes
    ----------
    main : Light or None
        The light that has shadow maps.
    lamps : sequence of Light
        What else is to be drawn in real time.
    environment : Environment
    shadow : ShadowPass
        Of everything; with baked light, of what has none.
    static_shadow : ShadowPass or None
        With baked light: of what has it.
    baked : BakedTextures or None
    main_baked : bool
        True if the light map knows the main light's shadows.
    main_transmittance : float
        Share of the main light that glass lets through to what is not in the light map.
    reflections : ReflectionTexture or None
    blended : bool
        Whether the sky is blended with the room, as for people to see; see `seen_sky`.
    outside : (int, float)
        See `shown_outside`.
    """

    main: Light | None
    lamps: Sequence[Light]
    environment: Environment
    shadow: ShadowPass
    static_shadow: ShadowPass | None = None
    baked: BakedTextures | None = None
    main_baked: bool = False
    main_transmittance: float = 1.0
    reflections: ReflectionTexture | None = None
    blended: bool = True
    outside: tuple[int, float] = NOTHING_OUTSIDE


class LightingPass:
    """Lights pictures of one size after the other."""

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._programs = programs
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}
        self._sky_shown: tuple[SkyMap, float | None] | None = None
        self._sky_texture: moderngl.Texture | None = None
        self._warned_of: Sequence[Light] | None = None
        self._lamps = context.buffer(reserve=MAX_LIGHTS * LAMP.itemsize, dynamic=True)

    def draw(self, targets: Targets, camera: Camera, illumination: Illumination) -> None:
        """Light the surfaces of `targets` into its picture."""
        assert targets.picture is not None
        targets.picture.use()
        context = self._context
        context.enable_only(moderngl.DEPTH_TEST)
        light, sky = self._chosen(illumination)
        environment = illumination.environment
        for program in (light, sky):
            set_camera(program, camera, environment)
        if environment.sky is not None:
            exposure = seen_exposure(environment) if illumination.blended else None
            self._show_sky(environment.sky, exposure, sky)
            factor = environment.outside_factor if illumination.blended else 1.0
            set_uniform(sky, "sky_factor", factor)
        self._set_lights(light, camera, illumination)
        _set_textures(light, targets, illumination)
        # The covering triangle lies at the far end: in front of it are surfaces, on it is sky.
        try:
            targets.picture.depth_mask = False
            context.depth_func = ">"
            self._array(light).render(moderngl.TRIANGLES, vertices=3)
            context.depth_func = "=="
            self._array(sky).render(moderngl.TRIANGLES, vertices=3)
        finally:
            targets.picture.depth_mask = True
            context.depth_func = "<"

    def close(self) -> None:
        """Free the buffers."""
        for resource in (*self._arrays.values(), self._lamps, self._sky_texture):
            if resource is not None:
                resource.release()

    def _chosen(self, illumination: Illumination) -> tuple[moderngl.Program, moderngl.Program]:
        """Return the programs for surfaces and sky."""
        lit: dict[str, int] = {}
        seen: dict[str, int] = {}
        if any(light.intensity > 0.0 for light in illumination.lamps):
            # Even a loop that ends at once costs a tenth of the pass.
            lit["LAMPS"] = 1
        if illumination.baked is not None:
            lit["BAKED"] = 1
            if illumination.reflections is not None:
                lit["REFLECTIONS"], lit["REFLECTION_POINTS"] = 1, MOST
        if illumination.environment.sky is not None:
            seen["SKY_MAP"] = 1
        return (
            self._programs.get("screen.vert", "lighting.frag", MAX_LIGHTS=MAX_LIGHTS, **lit),
            self._programs.get("screen.vert", "sky.frag", **seen),
        )

    def _array(self, program: moderngl.Program) -> moderngl.VertexArray:
        if program not in self._arrays:
            self._arrays[program] = self._context.vertex_array(program, [])
        return self._arrays[program]

    def _show_sky(self, sky: SkyMap, exposure: float | None, program: moderngl.Program) -> None:
        """Make a sky's picture readable; it is uploaded where it is another than before."""
        if self._sky_texture is None or (sky, exposure) != self._sky_shown:
            if self._sky_texture is not None:
                self._sky_texture.release()
            seen = seen_sky(sky, exposure)
            height, width, _ = seen.shape
            self._sky_texture = self._context.texture(
                (width, height), 3, seen.tobytes(), dtype="f2"
            )
            self._sky_texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            self._sky_texture.repeat_y = False
            self._sky_shown = sky, exposure
        self._sky_texture.use(SKY_UNIT)
        set_uniform(program, "sky_map", SKY_UNIT)

    def _set_lights(
        self, program: moderngl.Program, camera: Camera, illumination: Illumination
    ) -> None:
        sun = illumination.main
        lamps = [light for light in illumination.lamps if light.intensity > 0.0]
        if len(lamps) > MAX_LIGHTS and self._warned_of != illumination.lamps:
            self._warned_of = illumination.lamps
            _log.warning("only the %d strongest of %d lights are drawn", MAX_LIGHTS, len(lamps))
        rows = lamp_rows(strongest_lamps(lamps), camera.camera_from_world)
        self._lamps.write(rows.tobytes())
        self._lamps.bind_to_uniform_block(0)
        outside_id, outside_radiance = illumination.outside
        set_uniform(program, "outside_id", float(outside_id))
        set_uniform(program, "outside_radiance", outside_radiance)
        set_uniform(program, "lamp_count", len(rows))
        colour, towards = (0.0, 0.0, 0.0), np.array([0.0, 0.0, 1.0])
        if sun is not None:
            colour = sun.power
            towards = -camera.camera_from_world[:3, :3] @ np.asarray(sun.direction)
        set_uniform(program, "main_colour", colour)
        set_uniform(program, "main_towards", tuple(towards))
        shadow = illumination.shadow
        matrix = shadow.plan.map_from_world @ camera.world_from_camera
        set_uniform(program, "shadow_from_optical", _columns(matrix))
        set_uniform(program, "shadow_texel", (shadow.plan.texel_m, 1.0 / SIZE_PX, PENUMBRA_TEXELS))
        set_uniform(program, "main_baked", float(illumination.main_baked))
        set_uniform(program, "main_transmittance", illumination.main_transmittance)


def _set_textures(program: moderngl.Program, targets: Targets, illumination: Illumination) -> None:
    textures = {
        "surface": targets.surface,
        "shape": targets.shape,
        "albedo": targets.albedo,
        "shadow_map": illumination.shadow.texture,
    }
    for unit, (name, texture) in enumerate(textures.items()):
        assert texture is not None
        texture.use(unit)
        set_uniform(program, name, unit)
    if illumination.baked is None:
        return
    assert illumination.static_shadow is not None
    assert targets.light_at is not None
    illumination.baked.bind(program)
    targets.light_at.use(LIGHT_AT_UNIT)
    set_uniform(program, "light_at", LIGHT_AT_UNIT)
    illumination.static_shadow.texture.use(STATIC_SHADOW_UNIT)
    set_uniform(program, "static_shadow_map", STATIC_SHADOW_UNIT)
    if illumination.reflections is not None:
        illumination.reflections.bind(program)


def set_camera(program: moderngl.Program, camera: Camera, environment: Environment) -> None:
    """Set in a program of `picture.glsl` where it looks from, and what lies around."""
    set_lens(program, camera.intrinsics)
    set_uniform(program, "exposure", 2.0**environment.exposure)
    set_uniform(program, "eye", tuple(camera.world_from_camera[:3, 3]))
    set_uniform(program, "world_from_optical", _columns(camera.world_from_camera[:3, :3]))
    set_uniform(program, "ambient", environment.ambient)
    set_uniform(program, "sky_share", environment.sky_share)
    for name in ("sky_zenith", "sky_horizon", "sky_ground"):
        set_uniform(program, name, getattr(environment, name))
    plain = 1.0 if environment.background == "colour" else 0.0
    set_uniform(program, "background", (*environment.background_colour, plain))


def _columns(matrix: NDArray[np.float64]) -> tuple[float, ...]:
    """Return a matrix in GLSL's order of numbers."""
    return tuple(float(number) for number in matrix.T.reshape(-1))
