"""Light of a scene at one instant: updates shadow maps, baked light and reflections.

A snapshot comes in, a LIGHT for the shading kernel goes out. Without baked light there is one
shadow map of everything. With it there are two: what stands still is drawn into one of them once,
and only what moves is drawn again.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.drawing import ROW_PADDING, Drawing
from sailenv_ros.native.lamp import LAMP
from sailenv_ros.native.library import native_library
from sailenv_ros.native.light_maps import LayeredMap, blur_directions, sum_texels
from sailenv_ros.native.ray_types import RAY_LIGHT
from sailenv_ros.native.render_types import LIGHT, REFLECTION_POINT, address, record
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.cpu.traced_scene import TracedScene
from sailenv_ros.render.scene import reflection_map as reflections
from sailenv_ros.render.scene.baked_state import BakedState
from sailenv_ros.render.scene.lamps import MAX_LIGHTS, strongest_lamps
from sailenv_ros.render.scene.lightmap_compositing import (
    CompositedLight,
    composite_lightmap,
    light_alone,
    main_light,
)
from sailenv_ros.render.scene.mirrored_lamps import Seen, mirrored_lights
from sailenv_ros.render.scene.outside_light import shown_outside
from sailenv_ros.render.scene.reflection_store import ReflectionStore
from sailenv_ros.render.scene.room_reflections import RoomReflections, Share
from sailenv_ros.render.scene.seen_sky import seen_exposure, seen_sky
from sailenv_ros.render.scene.shadow_plan import SIZE_PX, ShadowPlan
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.lights import Light, SkyMap, lamp_rows
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["Radiance", "FrameLight", "with_exposure"]

_log = logging.getLogger(__name__)

Radiance: TypeAlias = Callable[
    [Camera, NDArray[np.void], NDArray[np.bool_], Light | None, bool], Seen
]
"""``radiance(camera, light, only, alone, lit)`` returns a picture of some instances; of lamps those
of the light `alone` glow if they are `lit`. If it is None, what emits of itself does."""

_texels_in_use: WeakValueDictionary[tuple[SkyMap, float | None], NDArray[np.float16]] = (
    WeakValueDictionary()
)
"""Of skies that something shows: 16 MB each."""


class ShadowMap:
    """A shadow map and its plan.

    Attributes
    ----------
    inverse_depth : (SIZE_PX, SIZE_PX + ROW_PADDING) float32
        1 - depth of the nearest caster, 0 where there is none.
    """

    def __init__(self, drawing: Drawing) -> None:
        self._drawing = drawing
        self._resting: NDArray[np.float32] | None = None
        self._changed = np.ones((SIZE_PX + 15) // 16, np.uint8)
        self.plan = ShadowPlan()
        self.inverse_depth: NDArray[np.float32] = _empty_map()

    def draw(
        self,
        light: Light,
        snapshot: WorldSnapshot,
        table: PartTable,
        *,
        casting: NDArray[np.bool_] | None = None,
        framed: NDArray[np.bool_] | None = None,
    ) -> None:
        """Bring the map up to date; see `ShadowPlan.update`."""
        redraw = self.plan.update(light, snapshot, casting=casting, framed=framed)
        if redraw is None:
            return
        poses = np.ascontiguousarray(redraw.poses)
        if redraw.keep:
            before = self._resting
            self._resting = self.inverse_depth
            self.inverse_depth = _empty_map() if before is None else before
            self._changed[:] = 1
        if redraw.resting is not None:
            if self._resting is None:
                self._resting = _empty_map()
            self._changed[:] = 1
            unused = np.ones_like(self._changed)
            over = None if redraw.clear else self._resting
            self._draw(poses, table, redraw.resting, self._resting, unused, resting=over)
        begin = self._resting if redraw.from_resting else None
        self._draw(poses, table, redraw.casters, self.inverse_depth, self._changed, resting=begin)

    def _draw(
        self,
        poses: NDArray[np.float64],
        table: PartTable,
        drawn: NDArray[np.bool_],
        inverse_depth: NDArray[np.float32],
        changed: NDArray[np.uint8],
        *,
        resting: NDArray[np.float32] | None,
    ) -> None:
        # From the map's sides, 0 to 1, to texels whose centres are integers.
        texels = np.diag([SIZE_PX, SIZE_PX, 1.0, 1.0])
        texels[:2, 3] = -0.5
        matrix = np.ascontiguousarray(texels @ self.plan.map_from_world)
        instances = table.instances(poses, None, drawn)
        self._drawing.shadow_map(
            matrix, instances, table.casters, inverse_depth, changed, resting=resting
        )


def _empty_map() -> NDArray[np.float32]:
    return np.zeros((SIZE_PX, SIZE_PX + ROW_PADDING), np.float32)


class FrameLight:
    """The light of the scene that is shown."""

    def __init__(
        self, drawing: Drawing, threads: int, store: ReflectionStore[Share] | None = None
    ) -> None:
        self._drawing = drawing
        self._shadow = ShadowMap(drawing)
        self._static_shadow: ShadowMap | None = None
        self._baked = BakedState()
        self._reflections = RoomReflections(
            partial(blur_directions, threads=threads),
            partial(sum_texels, threads=threads),
            store,
            native_library().digest,
            has_faces=False,
        )
        self._reflection_points = np.zeros(1, REFLECTION_POINT)
        self._sky: tuple[tuple[SkyMap, float | None], NDArray[np.float16]] | None = None
        self._lamps = np.zeros(0, LAMP)
        self._mirrored_lights = np.zeros(0, RAY_LIGHT)
        self._warned_of: Sequence[Light] | None = None
        self._light = np.zeros(1, LIGHT)
        self._light_map: LayeredMap | None = None
        self._of: tuple[SceneContents, CompositedLight | None] | None = None
        self._reflected: CompositedLight | None = None
        self._traced = TracedScene()

    def at(self, snapshot: WorldSnapshot, table: PartTable, radiance: Radiance) -> NDArray[np.void]:
        """Bring everything up to date for a snapshot.

        Returns
        -------
        light : (1,) LIGHT
            Points into arrays of this object; good until the next call.
        """
        contents = snapshot.contents
        main = main_light(contents.lights)
        composited = self._baked.update(snapshot)
        same = self._of is not None and self._of[0] is contents and self._of[1] is composited
        if not same:
            self._light = self._surroundings(snapshot, main)
        light = self._light
        if composited is None or contents.baked is None:
            if main is not None:
                self._shadow.draw(main, snapshot, table)
            self._set_shadows(light, self._shadow, self._shadow)
            if not same:
                lamps = tuple(lamp for lamp in contents.lights if lamp is not main)
                self._set_lamps(light, lamps)
            self._of = contents, composited
            return light
        still = table.at_baked_pose(snapshot)
        if self._static_shadow is None:
            self._static_shadow = ShadowMap(self._drawing)
        if main is not None:
            self._static_shadow.draw(main, snapshot, table, casting=still, framed=still)
            self._shadow.draw(main, snapshot, table, casting=~still, framed=still)
        self._set_shadows(light, self._shadow, self._static_shadow)
        light["instance_light_at"] = address(self._baked.instances)
        light["vertex_factors_at"] = address(self._baked.vertex_factors)
        light["traced_at"] = address(self._traced.update(snapshot, table, still))
        if same:
            self._set_reflection_table(light, snapshot)
            return light
        self._set_lamps(light, composited.live)
        if self._reflected is not composited or self._light_map is None:
            self._light_map = _layered(composited, self._light_map)
        _set_baked(light, composited, self._light_map)
        if self._reflected is not composited:
            look = partial(self._look, light, snapshot, main, radiance, still)
            self._reflections.update(snapshot, still, main, look, composited.live)
            self._reflected = composited
        self._mirrored_lights = mirrored_lights(contents.lights, main, composited.live)
        light["mirrored_lights_at"] = address(self._mirrored_lights)
        light["mirrored_light_count"] = len(self._mirrored_lights)
        self._set_reflections(light)
        self._set_reflection_table(light, snapshot)
        self._of = contents, composited
        return light

    def _surroundings(self, snapshot: WorldSnapshot, main: Light | None) -> NDArray[np.void]:
        environment = snapshot.contents.environment
        light = record(
            LIGHT,
            main_towards=(0.0, 0.0, 1.0),
            ambient=environment.ambient,
            sky_share=environment.sky_share,
            sky_zenith=environment.sky_zenith,
            sky_horizon=environment.sky_horizon,
            sky_ground=environment.sky_ground,
            background=environment.background_colour,
            background_plain=environment.background == "colour",
            exposure=2.0**environment.exposure,
        )
        if main is not None:
            light["main_colour"][0] = main.power
            light["main_towards"][0] = -np.asarray(main.direction)
        light["outside_id"], light["outside_radiance"] = shown_outside(snapshot.contents)
        if environment.sky is not None:
            wanted = environment.sky, seen_exposure(environment)
            if self._sky is None or self._sky[0] != wanted:
                self._sky = None  # two of them are never needed
                self._sky = wanted, _sky_texels(*wanted)
            _set_sky(light, self._sky[1], environment.outside_factor)
        return light

    def _set_shadows(self, light: NDArray[np.void], shadow: ShadowMap, static: ShadowMap) -> None:
        light["map_from_world"][0] = shadow.plan.map_from_world[:3].reshape(-1)
        light["texel_m"] = shadow.plan.texel_m
        light["shadow_size"] = SIZE_PX
        light["shadow_at"] = address(shadow.inverse_depth)
        light["static_shadow_at"] = address(static.inverse_depth)

    def _set_lamps(self, light: NDArray[np.void], lamps: Sequence[Light]) -> None:
        shining = sum(lamp.intensity > 0.0 for lamp in lamps)
        if shining > MAX_LIGHTS and self._warned_of != lamps:
            self._warned_of = lamps
            _log.warning("only the %d strongest of %d lights are drawn", MAX_LIGHTS, shining)
        self._lamps = lamp_rows(strongest_lamps(lamps))
        light["lamp_count"] = len(self._lamps)
        light["lamps_at"] = address(self._lamps)

    def _set_reflections(self, light: NDArray[np.void]) -> None:
        layers, points = self._reflections.layers, self._reflections.points
        self._reflection_points = np.zeros(len(layers), REFLECTION_POINT)
        self._reflection_points["position"] = points.points
        self._reflection_points["light"] = self._reflections.around
        light["reflecting"] = 1
        light["reflections_at"] = address(layers)
        light["reflection_layers"], light["reflection_edge"] = layers.shape[1:3]
        light["reflection_scale"] = reflections.EDGE / layers.shape[2]
        light["layers_per_roughness"] = reflections.layers_per_roughness()
        light["reflection_points_at"] = address(self._reflection_points)
        light["room_low"][0], light["room_high"][0] = points.box

    def _set_reflection_table(self, light: NDArray[np.void], snapshot: WorldSnapshot) -> None:
        light["reflection_table_at"] = address(self._reflections.points.table(snapshot))

    def _look(
        self,
        full: NDArray[np.void],
        snapshot: WorldSnapshot,
        main: Light | None,
        radiance: Radiance,
        still: NDArray[np.bool_],
        alone: Light | None,
        views: list[tuple[Camera, bool]],
    ) -> list[Seen]:
        """Look at what stands still under one light alone; see `room_reflections.Look`."""
        contents = snapshot.contents
        assert contents.baked is not None
        light = with_exposure(full, 1.0)
        light["reflecting"] = light["lamp_count"] = 0
        light["main_colour"] = 0.0
        # Nothing that moves casts a shadow into what is mirrored.
        unshadowed = _empty_map()
        light["shadow_at"] = address(unshadowed)
        lamp, sky = lamp_rows(()), contents.environment.sky
        if alone is None and sky is not None:
            texels = _sky_texels(sky, None)
            _set_sky(light, texels, 1.0)
        if alone is None:
            composited = composite_lightmap(contents.baked.of_still, (), contents.environment)
        else:
            is_main = main is not None and alone.name == main.name
            composited = light_alone(contents.baked.of_still, alone, is_main=is_main)
            light["background_plain"], light["background"] = 1, 0.0
            if is_main:
                light["main_colour"][0] = alone.power
            elif composited.live:
                lamp = lamp_rows((alone,))
                light["lamp_count"], light["lamps_at"] = 1, address(lamp)
        light_map = _layered(composited)
        _set_baked(light, composited, light_map)
        instances = self._baked.around(snapshot, composited.probes)
        light["instance_light_at"] = address(instances)
        return [radiance(camera, light, still, alone, lit) for camera, lit in views]


def with_exposure(light: NDArray[np.void], factor: float) -> NDArray[np.void]:
    """Return the same light with another exposure."""
    result = light.copy()
    result["exposure"] = factor
    return result


def _layered(composited: CompositedLight, before: LayeredMap | None = None) -> LayeredMap:
    layers = composited.layers
    return LayeredMap(layers.terms, layers.more, layers.shown, before)


def _set_baked(light: NDArray[np.void], composited: CompositedLight, light_map: LayeredMap) -> None:
    light["baked"] = 1
    light["light_map_at"] = address(light_map.record)
    light["light_map_height"], light["light_map_width"] = light_map.height, light_map.width
    light["main_baked"] = float(composited.main_baked)
    light["main_clear"] = composited.main_transmittance
    edges = composited.main_edges  # kept by `composited`, as long as it is shown
    light["edge_index_at"] = address(None if edges is None else edges.index)
    light["edge_blocks_at"] = address(None if edges is None else edges.blocks)


def _set_sky(light: NDArray[np.void], texels: NDArray[np.float16], factor: float) -> None:
    light["sky_factor"] = factor
    light["sky_map_at"] = address(texels)
    light["sky_height"], light["sky_width"] = len(texels), texels.shape[1] - 1


def _sky_texels(sky: SkyMap, exposure: float | None) -> NDArray[np.float16]:
    """Return (H, W + 1, 4) of `seen_sky`: the first column is repeated behind the last."""
    texels = _texels_in_use.get((sky, exposure))
    if texels is None:
        seen = seen_sky(sky, exposure)
        height, width, _ = seen.shape
        texels = _texels_in_use[sky, exposure] = np.zeros((height, width + 1, 4), np.float16)
        texels[:, :width, :3] = seen
        texels[:, width] = texels[:, 0]
    return texels
