"""Works out the light on everything that stands still. From `WorldSnapshot` to `BakedLight`.

Knows neither OpenGL nor PyBullet nor where results are kept.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.bake.back_to_back import back_to_back_faces
from sailenv_ros.bake.bounces import bounced_radiance, patches_of
from sailenv_ros.bake.denoise import denoised, dilated
from sailenv_ros.bake.direct import Points, arriving
from sailenv_ros.bake.facing import facing_the_light
from sailenv_ros.bake.fingerprint import fingerprint
from sailenv_ros.bake.gather import BACK, Surroundings, gathered, seen_from, window_light
from sailenv_ros.bake.layout import Layout, is_simple, laid_out
from sailenv_ros.bake.light_probes import (
    dilated_grid,
    probe_grid,
    probe_light,
    probe_positions,
    straight_light,
)
from sailenv_ros.bake.ray_patterns import net
from sailenv_ros.bake.rays import NEVER, RayScene, in_chunks
from sailenv_ros.bake.reflectance import albedo_of, emission_of
from sailenv_ros.bake.sampling import tile_shift
from sailenv_ros.bake.settings import BakeSettings
from sailenv_ros.bake.sky import panes
from sailenv_ros.bake.sky_picture import sky_picture
from sailenv_ros.bake.static_geometry import static_geometry_of
from sailenv_ros.bake.texels import rasterised
from sailenv_ros.bake.visibility import probe_visibility, visible_triangles
from sailenv_ros.baked_light import BakedLight, LightLayer, ProbeGrid
from sailenv_ros.lights import Light
from sailenv_ros.snapshot import WorldSnapshot

__all__ = ["Report", "bake"]

Floats = NDArray[np.float32]
Report = Callable[[str, float], None]
"""Is told the name of the stage and which share of the whole is done, 0 to 1."""

MOST_BACKS = 0.25
"""A texel that sees more backs of surfaces than this share lies inside of something."""

CHUNK_RAYS = 1_000_000
"""Cast at a time by one thread."""


def bake(
    snapshot: WorldSnapshot,
    *,
    settings: BakeSettings | None = None,
    report: Report = lambda stage, share: None,
    workers: int = 0,
) -> BakedLight:
    """Work out the light on everything that stands still.

    Parameters
    ----------
    snapshot : WorldSnapshot
        Its poses, materials, sky, and its lights' places count; colours and intensities do not.
    settings : BakeSettings or None
    report : callable
        See `Report`.
    workers : int
        Threads; 0 is one for each core. The result is the same for any number.
    """
    settings = settings or BakeSettings()
    work = _Bake(snapshot, settings, report, workers or os.cpu_count() or 1)
    return work.run()


@dataclass(eq=False, slots=True)
class _Light:
    """What is known of one light at the texels, and of the surroundings (`light` is None)."""

    light: Light | None
    direct: Floats
    visibility: Floats | None = None


class _Bake:
    """One bake; what the stages share."""

    def __init__(
        self, snapshot: WorldSnapshot, settings: BakeSettings, report: Report, workers: int
    ) -> None:
        self._snapshot, self._settings = snapshot, settings
        self._report, self._workers = report, workers
        self._done = 0.0

    def run(self) -> BakedLight:
        settings, contents = self._settings, self._snapshot.contents
        geometry = static_geometry_of(self._snapshot)
        scene = RayScene(geometry)
        self._grid = probe_grid(geometry.bounds(), settings)
        self._spots = probe_positions(self._grid)
        self._begin_stage("visibility", 0.04)
        self._visibility = probe_visibility(geometry, scene, self._spots, settings.probe_rays)
        visible = visible_triangles(geometry, self._visibility.seen)
        layout = laid_out(geometry, settings, visible, self._begin_stage("surfaces", 0.06))
        texels = facing_the_light(geometry, scene, rasterised(geometry, layout))
        self._geometry, self._texels = geometry, texels
        self._around = Surroundings(
            scene=scene,
            faces=geometry.faces,
            two_sided=geometry.two_sided,
            paired=back_to_back_faces(geometry),
            places=layout.places,
            index=texels.index,
            sky=sky_picture(contents.environment),
            panes=panes(geometry),
        )
        self._points = Points(
            positions=texels.positions,
            normals=texels.normals,
            faces=texels.faces,
            shifts=tile_shift(texels.rows, texels.columns),
        )
        albedo = albedo_of(geometry, layout, texels)
        seen, sky = self._gather_visibility()
        self._nearness = np.zeros(texels.count, dtype=np.float32)
        self._valid = np.mean(seen == BACK, axis=1) <= MOST_BACKS
        lights = [_Light(None, np.zeros(texels.count, np.float32))]
        lights += [self._straight(light) for light in contents.lights]
        radiance = self._radiance(lights, albedo, emission_of(geometry, texels), seen, sky)
        bounced = self._final_gather(radiance)
        probes = self._probes(lights, radiance)
        return self._result(layout, lights, bounced, *probes)

    def _begin_stage(self, stage: str, weight: float) -> Callable[[float], None]:
        """Begin a stage that takes this share of the whole time."""
        begun, self._done = self._done, min(self._done + weight, 1.0)
        self._report(stage, begun)
        return lambda share: self._report(stage, begun + weight * share)

    def _chunks(
        self,
        work: Callable[[int, int], None],
        count: int,
        rays: int,
        report: Callable[[float], None],
    ) -> None:
        size = max(CHUNK_RAYS // max(rays, 1), 1)
        in_chunks(work, count, size, self._workers, report)

    def _gather_visibility(self) -> tuple[NDArray[np.int32], Floats]:
        """Find which texels see which, and how much of the sky arrives straight at each."""
        count, rays = self._texels.count, self._settings.coarse_rays
        pattern = net(rays)
        seen = np.empty((count, rays), dtype=np.int32)
        sky = np.empty((count, 3), dtype=np.float32)
        few = net(4)

        def cast(first: int, end: int) -> None:
            points = self._points.part(slice(first, end))
            seen[first:end], _, directions = seen_from(self._around, points, pattern)
            sky[first:end] = window_light(self._around, points, seen[first:end], directions, few)

        self._chunks(cast, count, rays, self._begin_stage("gather visibility", 0.15))
        return seen, sky

    def _straight(self, light: Light) -> _Light:
        count, rays = self._texels.count, self._settings.light_rays
        pattern = net(rays)
        direct, visibility = np.zeros(count, np.float32), np.zeros(count, np.float32)
        lit = np.flatnonzero(self._valid)

        def shine(first: int, end: int) -> None:
            chosen = lit[first:end]
            points = self._points.part(chosen)
            direct[chosen], visibility[chosen] = arriving(
                self._around.scene, light, points, pattern
            )

        share = 0.18 / len(self._snapshot.contents.lights)
        self._chunks(shine, len(lit), rays, self._begin_stage(light.name, share))
        return _Light(light, direct, visibility if light.type == "directional" else None)

    def _radiance(
        self,
        lights: list[_Light],
        albedo: Floats,
        emission: Floats,
        seen: NDArray[np.int32],
        sky: Floats,
    ) -> Floats:
        """Return (N, 3 L) float32: what each texel sends out, light by light."""
        report = self._begin_stage("bounces", 0.05)
        first = np.concatenate(
            [emission + albedo * sky, *(albedo * light.direct[:, None] for light in lights[1:])],
            axis=1,
        )
        first[~self._valid] = 0.0
        radiance = bounced_radiance(
            patches_of(self._geometry, self._texels),
            seen,
            self._valid,
            first,
            albedo,
            self._settings.bounces,
        )
        radiance[~self._valid] = 0.0
        report(1.0)
        return radiance

    def _final_gather(self, radiance: Floats) -> Floats:
        """Return (N, 3 L) float32: what arrives at each texel by way of others and from the sky."""
        settings, texels = self._settings, self._texels
        window_pattern = net(settings.window_rays)
        light = np.zeros((texels.count, radiance.shape[1]), dtype=np.float32)
        owner = self._geometry.owner[texels.triangle]
        simple = np.array([is_simple(instance.model) for instance in self._geometry.instances])

        def gather_with(rays: int, lit: NDArray[np.intp], report: Callable[[float], None]) -> None:
            pattern = net(rays)

            def gather(first: int, end: int) -> None:
                chosen = lit[first:end]
                points = self._points.part(chosen)
                light[chosen], self._nearness[chosen] = gathered(
                    self._around, points, pattern, window_pattern, radiance
                )

            self._chunks(gather, len(lit), rays, report)

        if texels.count:
            plain = simple[owner]
            chosen = np.flatnonzero(self._valid & plain)
            gather_with(settings.rays, chosen, self._begin_stage("final gather on walls", 0.37))
            chosen = np.flatnonzero(self._valid & ~plain)
            gather_with(
                settings.fine_rays, chosen, self._begin_stage("final gather on furniture", 0.11)
            )
        return self._denoised_and_dilated(light)

    def _denoised_and_dilated(self, values: Floats) -> Floats:
        """Denoise values of texels, and dilate them into texels inside of something."""
        values = denoised(self._geometry, self._texels, values, self._valid, self._nearness)
        return dilated(self._geometry, self._texels, values, self._valid)

    def _probes(self, lights: list[_Light], radiance: Floats) -> tuple[ProbeGrid, Floats, Floats]:
        """Return the grid, (L, N, 4) direct and (N, 4, 3 L) bounced light of its probes."""
        settings, grid, positions = self._settings, self._grid, self._spots
        count = len(positions)
        bounced = np.empty((count, 4, radiance.shape[1]), dtype=np.float32)

        def gather(first: int, end: int) -> None:
            bounced[first:end] = probe_light(
                self._around, positions[first:end], radiance, settings.probe_rays
            )

        self._chunks(gather, count, settings.probe_rays, self._begin_stage("probes", 0.04))
        direct = np.zeros((len(lights), count, 4), dtype=np.float32)
        for place, entry in enumerate(lights):
            if entry.light is not None and entry.light.type != "directional":
                direct[place] = straight_light(
                    self._around.scene, entry.light, positions, net(settings.light_rays)
                )
        unknown = ~self._visibility.useful
        bounced = dilated_grid(bounced, unknown, grid)
        direct = np.stack([dilated_grid(d[..., None], unknown, grid)[..., 0] for d in direct])
        return grid, direct, bounced

    def _clear(self, light: Light | None) -> float:
        """Return how much of a light glass lets through, on the mean over the probes it reaches."""
        if light is None or light.type != "directional":
            return 1.0
        spots = self._spots[self._visibility.useful]
        towards = np.tile(-np.asarray(light.direction, np.float32), (len(spots), 1))
        never = np.full(len(spots), NEVER, np.float32)
        share = self._around.scene.share_that_passes(spots, towards, never)
        return float(share[share > 0.0].mean(dtype=np.float64)) if share.any() else 1.0

    def _result(
        self,
        layout: Layout,
        lights: list[_Light],
        bounced: Floats,
        grid: ProbeGrid,
        probe_direct: Floats,
        probe_bounced: Floats,
    ) -> BakedLight:
        """Lay everything out as the renderer takes it."""
        texels, geometry = self._texels, self._geometry
        at = texels.rows, texels.columns
        layers = []
        for place, entry in enumerate(lights):
            mine = slice(3 * place, 3 * place + 3)
            # An area light's shadows are as soft as the texels are fine, and its rays are few.
            soft = entry.light is not None and entry.light.type == "area"
            known = entry.direct[:, None]
            known = (
                self._denoised_and_dilated(known)
                if soft
                else dilated(geometry, texels, known, self._valid)
            )
            direct = np.zeros(texels.index.shape, dtype=np.float16)
            direct[at] = known[:, 0]
            map_of = np.zeros((*texels.index.shape, 3), dtype=np.float16)
            map_of[at] = bounced[:, mine]
            visibility = None
            if entry.visibility is not None:
                share = dilated(geometry, texels, entry.visibility[:, None], self._valid)
                visibility = np.zeros(texels.index.shape, dtype=np.uint8)
                visibility[at] = np.rint(share[:, 0] * 255.0)
            layers.append(
                LightLayer(
                    light=entry.light,
                    direct=direct,
                    bounced=map_of,
                    probe_direct=np.repeat(
                        probe_direct[place].reshape(*grid.shape, 4, 1), 3, axis=-1
                    ).astype(np.float16),
                    probe_bounced=probe_bounced[:, :, mine]
                    .reshape(*grid.shape, 4, 3)
                    .astype(np.float16),
                    visibility=visibility,
                    clear=self._clear(entry.light),
                )
            )
        return BakedLight(
            fingerprint=fingerprint(self._snapshot, self._settings),
            charts=layout.charts,
            layers=tuple(layers),
            probes=grid,
        )
