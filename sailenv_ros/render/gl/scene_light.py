"""Light of a scene at one instant: updates shadow maps, baked light and reflections.

A snapshot comes in, an `Illumination` for the lighting pass goes out. Without baked light there is
one shadow map of everything. With it there are two: what stands still is drawn into one of them
once, and only what moves is drawn again.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from functools import partial

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.light_maps import blur_directions
from sailenv_ros.render.gl.baked_textures import BakedTextures
from sailenv_ros.render.gl.draw_list import DrawList
from sailenv_ros.render.gl.geometry_buffers import GeometryBuffers
from sailenv_ros.render.gl.lighting_pass import Illumination
from sailenv_ros.render.gl.programs import ProgramCache
from sailenv_ros.render.gl.reflection_texture import ReflectionTexture
from sailenv_ros.render.gl.shadow_pass import ShadowPass
from sailenv_ros.render.scene.lightmap_compositing import (
    CompositedLight,
    composite_lightmap,
    light_alone,
    main_light,
    sum_texels,
)
from sailenv_ros.render.scene.mirrored_lamps import Seen
from sailenv_ros.render.scene.outside_light import shown_outside
from sailenv_ros.render.scene.room_reflections import RoomReflections
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.lights import Light
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["Radiance", "SceneLight"]

Radiance = Callable[[Camera, Illumination, NDArray[np.bool_]], Seen]
"""``radiance(camera, illumination, only)`` gives a picture of some instances."""


class SceneLight:
    """The light of the scene that is shown, in one context.

    Attributes
    ----------
    baked : BakedTextures
    """

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._shadow = ShadowPass(context, programs)
        self._static_shadow: ShadowPass | None = None
        self._programs = programs
        self.baked = BakedTextures(context)
        self._room = RoomReflections(partial(blur_directions, threads=thread_count()), sum_texels)
        self._reflections = ReflectionTexture(context)
        self._reflected: CompositedLight | None = None

    def at(
        self,
        snapshot: WorldSnapshot,
        draws: DrawList,
        geometry: GeometryBuffers,
        radiance: Radiance,
    ) -> Illumination:
        """Bring everything up to date for a snapshot; `draws` must be placed again afterwards."""
        contents = snapshot.contents
        main = main_light(contents.lights)
        composited = self.baked.show(snapshot)
        if composited is None or contents.baked is None:
            if main is not None:
                self._shadow.draw(main, snapshot, draws, geometry)
            return Illumination(
                outside=shown_outside(contents),
                main=main,
                lamps=tuple(light for light in contents.lights if light is not main),
                environment=contents.environment,
                shadow=self._shadow,
            )
        still = draws.at_baked_pose(snapshot)
        if self._reflected is not composited:
            # Nothing that moves casts a shadow into what is mirrored.
            nothing = np.zeros_like(still)
            static_shadow = self._draw_two_maps(main, snapshot, draws, geometry, still, nothing)
            self._reflect(snapshot, main, static_shadow, draws, radiance, still, composited.live)
            draws.show_lamps()
            self._reflected = composited
        static_shadow = self._draw_two_maps(main, snapshot, draws, geometry, still, ~still)
        self._reflections.write_table(self._room.points.table(snapshot))
        return Illumination(
            outside=shown_outside(contents),
            main=main,
            lamps=composited.live,
            environment=contents.environment,
            shadow=self._shadow,
            static_shadow=static_shadow,
            baked=self.baked,
            main_baked=composited.main_baked,
            main_transmittance=composited.main_transmittance,
            reflections=self._reflections,
        )

    def close(self) -> None:
        """Free everything on the GPU."""
        for resource in (self._shadow, self._static_shadow, self.baked, self._reflections):
            if resource is not None:
                resource.close()

    def _draw_two_maps(
        self,
        main: Light | None,
        snapshot: WorldSnapshot,
        draws: DrawList,
        geometry: GeometryBuffers,
        still: NDArray[np.bool_],
        moving: NDArray[np.bool_],
    ) -> ShadowPass:
        if self._static_shadow is None:
            self._static_shadow = ShadowPass(self._context, self._programs)
        if main is not None:
            self._static_shadow.draw(main, snapshot, draws, geometry, casting=still, framed=still)
            self._shadow.draw(main, snapshot, draws, geometry, casting=moving, framed=still)
        return self._static_shadow

    def _reflect(
        self,
        snapshot: WorldSnapshot,
        main: Light | None,
        static_shadow: ShadowPass,
        draws: DrawList,
        radiance: Radiance,
        still: NDArray[np.bool_],
        live: Collection[Light],
    ) -> None:
        """Bring the reflection maps up to date."""
        alone_textures = BakedTextures(self._context)
        look = partial(
            self._look, alone_textures, snapshot, main, static_shadow, draws, radiance, still
        )
        try:
            self._room.update(snapshot, still, main, look, live)
        finally:
            alone_textures.close()
        points = self._room.points
        self._reflections.write(self._room.layers, self._room.around, points.points, points.box)

    def _look(
        self,
        textures: BakedTextures,
        snapshot: WorldSnapshot,
        main: Light | None,
        static_shadow: ShadowPass,
        draws: DrawList,
        radiance: Radiance,
        still: NDArray[np.bool_],
        alone: Light | None,
        views: list[tuple[Camera, bool]],
    ) -> list[Seen]:
        """Look at what stands still under one light alone; see `room_reflections.Look`."""
        contents = snapshot.contents
        assert contents.baked is not None
        environment, is_main = contents.environment, False
        if alone is None:
            composited = composite_lightmap(contents.baked.of_still, (), environment)
        else:
            is_main = main is not None and alone.name == main.name
            composited = light_alone(contents.baked.of_still, alone, is_main=is_main)
            environment = replace(
                environment, background="colour", background_colour=(0.0, 0.0, 0.0)
            )
        textures.show_alone(snapshot, composited)
        illumination = Illumination(
            main=alone if is_main else None,
            lamps=composited.live,
            environment=environment,
            shadow=self._shadow,
            static_shadow=static_shadow,
            baked=textures,
            main_baked=composited.main_baked,
            main_transmittance=composited.main_transmittance,
            blended=False,
        )
        seen = []
        for camera, lit in views:
            draws.glow_by(alone, lit=lit)
            seen.append(radiance(camera, illumination, still))
        return seen
