"""What lights a scene at one instant: shadow maps, baked light, reflections, brought up to date.

A snapshot comes in, an `Illumination` for the lighting pass goes out. Without baked light there is
one shadow map of everything. With it there are two: what stands still is drawn into one of them
once, and only what moves is drawn again.
"""

from __future__ import annotations

from collections.abc import Callable

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.baked_light import ProbeGrid
from sailenv_ros.camera import Camera
from sailenv_ros.lights import Light
from sailenv_ros.render.baked_textures import BakedTextures
from sailenv_ros.render.draw_list import DrawList
from sailenv_ros.render.geometry_buffers import GeometryBuffers
from sailenv_ros.render.lighting_pass import Illumination
from sailenv_ros.render.lightmap_compositing import CompositedLight, main_light
from sailenv_ros.render.programs import ProgramCache
from sailenv_ros.render.reflection_map import (
    EDGE,
    cube_cameras,
    flattened,
    prefilter,
    view_point,
)
from sailenv_ros.render.reflection_texture import ReflectionTexture
from sailenv_ros.render.shadow_pass import ShadowPass
from sailenv_ros.snapshot import WorldSnapshot

__all__ = ["Radiance", "SceneLight"]

Radiance = Callable[[Camera, Illumination, NDArray[np.bool_]], NDArray[np.float32]]
"""``radiance(camera, illumination, only)`` gives (H, W, 3): a picture of some instances."""


class SceneLight:
    """The light of the scene that is shown, in one context."""

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._shadow = ShadowPass(context, programs)
        self._static_shadow: ShadowPass | None = None
        self._programs = programs
        self._baked = BakedTextures(context)
        self._reflections: ReflectionTexture | None = None
        self._reflected: CompositedLight | None = None

    def at(
        self,
        snapshot: WorldSnapshot,
        draws: DrawList,
        geometry: GeometryBuffers,
        radiance: Radiance,
    ) -> Illumination:
        """Bring everything up to date for a snapshot; `draws` must be placed anew afterwards."""
        contents = snapshot.contents
        main = main_light(contents.lights)
        composited = self._baked.show(snapshot)
        if composited is None or contents.baked is None:
            if main is not None:
                self._shadow.draw(main, snapshot, draws, geometry)
            return Illumination(
                main=main,
                lamps=tuple(light for light in contents.lights if light is not main),
                environment=contents.environment,
                shadow=self._shadow,
            )
        still = draws.at_baked_pose(snapshot)
        static_shadow = self._draw_two_maps(main, snapshot, draws, geometry, still)
        if self._reflected is not composited:
            plain = self._illumination(snapshot, composited, static_shadow, None)
            self._reflect(plain, contents.baked.probes, radiance, still)
            self._reflected = composited
        return self._illumination(snapshot, composited, static_shadow, self._reflections)

    def close(self) -> None:
        """Free everything on the GPU."""
        for resource in (self._shadow, self._static_shadow, self._baked, self._reflections):
            if resource is not None:
                resource.close()

    def _draw_two_maps(
        self,
        main: Light | None,
        snapshot: WorldSnapshot,
        draws: DrawList,
        geometry: GeometryBuffers,
        still: NDArray[np.bool_],
    ) -> ShadowPass:
        if self._static_shadow is None:
            self._static_shadow = ShadowPass(self._context, self._programs)
        if main is not None:
            self._static_shadow.draw(main, snapshot, draws, geometry, casting=still, framed=still)
            self._shadow.draw(main, snapshot, draws, geometry, casting=~still, framed=still)
        return self._static_shadow

    def _illumination(
        self,
        snapshot: WorldSnapshot,
        composited: CompositedLight,
        static_shadow: ShadowPass,
        reflections: ReflectionTexture | None,
    ) -> Illumination:
        contents = snapshot.contents
        return Illumination(
            main=main_light(contents.lights),
            lamps=composited.live,
            environment=contents.environment,
            shadow=self._shadow,
            static_shadow=static_shadow,
            baked=self._baked,
            main_baked=composited.main_baked,
            main_transmittance=composited.main_transmittance,
            reflections=reflections,
        )

    def _reflect(
        self,
        plain: Illumination,
        probes: ProbeGrid,
        radiance: Radiance,
        still: NDArray[np.bool_],
    ) -> None:
        """Look around from the middle of the room, at what stands still."""
        middle, box = view_point(probes)
        cameras = cube_cameras(middle)
        pictures = [radiance(camera, plain, still) for camera in cameras]
        if self._reflections is None:
            self._reflections = ReflectionTexture(self._context)
        layers = prefilter(flattened(cameras, pictures, EDGE))
        self._reflections.write(layers, middle, box)
