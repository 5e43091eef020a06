"""Computes the light on everything that stands still. From `WorldSnapshot` to `BakedLight`.

Knows neither OpenGL nor PyBullet nor where results are kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.array_coding import rounded
from sailenv_ros.light.bake.back_to_back import back_to_back_faces
from sailenv_ros.light.bake.bounces import Patches, patches_of
from sailenv_ros.light.bake.denoise import denoised
from sailenv_ros.light.bake.direct import Points
from sailenv_ros.light.bake.emitters import emitters_of
from sailenv_ros.light.bake.facing import lit_texels
from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.gather import Surroundings
from sailenv_ros.light.bake.lamp_glow import glows_of
from sailenv_ros.light.bake.layout import laid_out
from sailenv_ros.light.bake.light_probes import (
    ProbeViews,
    dilated_grid,
    probe_grid,
    probe_light,
    probe_positions,
    straight_light,
)
from sailenv_ros.light.bake.mirrors import mirror_shares, with_images
from sailenv_ros.light.bake.reflectance import albedo_of, emission_of
from sailenv_ros.light.bake.sampling import tile_shift
from sailenv_ros.light.bake.settings import BakeSettings, drafted
from sailenv_ros.light.bake.sky import panes
from sailenv_ros.light.bake.sky_picture import sky_picture
from sailenv_ros.light.bake.solving import Samples, SolvedLight, Solver, Stages
from sailenv_ros.light.bake.sun_edges import sun_edges
from sailenv_ros.light.bake.texel_light import texel_light
from sailenv_ros.light.bake.visibility import probe_visibility, visible_triangles
from sailenv_ros.native.bake_types import SkyWindows
from sailenv_ros.rays.light_rays import NEVER, RayScene
from sailenv_ros.rays.ray_patterns import low_discrepancy_points
from sailenv_ros.rays.static_geometry import static_geometry_of
from sailenv_ros.types.baked_light import BakedLight, LightLayer, SunEdges
from sailenv_ros.types.lights import Light
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["Preview", "Report", "bake"]

Floats = NDArray[np.float32]
Report = Callable[[str, float], None]
"""Is told the name of the stage and which share of the whole is done, 0 to 1."""

DRAFT_SMOOTHING = 5
"""Number of smoothing passes of a draft over tiles: details beyond few rays are left out, not
noisy."""

Preview = Callable[[BakedLight], None]
"""Is given light of the same scene that is right, but rougher than the final one."""


def bake(
    snapshot: WorldSnapshot,
    *,
    settings: BakeSettings | None = None,
    report: Report = lambda stage, share: None,
    preview: Preview | None = None,
    workers: int = 0,
) -> BakedLight:
    """Compute the light on everything that stands still.

    Parameters
    ----------
    snapshot : WorldSnapshot
        Its poses, materials, sky, and its lights' places count; colours and intensities do not.
    settings : BakeSettings or None
    report : callable
        See `Report`.
    preview : callable or None
        See `Preview`; called twice: with light that has a value for each 4 by 4 texels, and with
        light at every texel by the first pass of rays.
    workers : int
        Threads; 0 is one for each core. The result is the same for any number.
    """
    settings = settings or BakeSettings()
    return _Bake(snapshot, settings, Stages(report, workers), preview).run()


class _Bake:
    """One bake; what the stages share."""

    def __init__(
        self,
        snapshot: WorldSnapshot,
        settings: BakeSettings,
        stages: Stages,
        preview: Preview | None,
    ) -> None:
        self._snapshot, self._settings = snapshot, settings
        self._stages, self._preview = stages, preview
        self._edges: dict[str, SunEdges] = {}

    def run(self) -> BakedLight:
        settings, stages, lights = self._settings, self._stages, self._snapshot.contents.lights
        samples = self._prepared()
        if self._preview is not None:
            stages.begin("draft", 0.06)
            self._preview(self._draft(samples))
        solver = Solver(samples, lights, settings, stages)
        solver.begin((0.44, 0.16, 0.1))
        if self._preview is not None and settings.rays > settings.pass_rays:
            self._preview(self._result(solver))
        passes = settings.rays // settings.pass_rays
        for number in range(1, passes):
            solver.refine(stages.begin(f"pass {number + 1} of {passes}", 0.0))
        done = stages.begin("result", 0.05)
        result = self._result(solver)
        done(1.0)
        return result

    def _prepared(self) -> Samples:
        """Lay out the map, and find what its texels are."""
        settings, contents, stages = self._settings, self._snapshot.contents, self._stages
        geometry = static_geometry_of(self._snapshot)
        scene = RayScene(geometry)
        self._grid = probe_grid(geometry.bounds(), settings)
        self._spots = probe_positions(self._grid)
        stages.begin("visibility", 0.02)
        self._visibility = probe_visibility(
            geometry, scene, self._spots, settings.probe_rays, stages.workers
        )
        visible = visible_triangles(geometry, self._visibility.seen)
        layout = laid_out(
            geometry, settings, visible, stages.begin("surfaces", 0.14),
            layers=1 + len(contents.lights),
        )  # fmt: skip
        texels = lit_texels(geometry, scene, layout, stages.workers)
        self._geometry, self._texels, self._layout = geometry, texels, layout
        albedo = albedo_of(geometry, layout, texels)
        emission = emission_of(geometry, layout, texels)
        drawn = contents.instances
        glows = glows_of(geometry, texels.triangle, {d.instance.id: d.lit_by for d in drawn})
        mirrors = mirror_shares(geometry, {d.instance.id: d.instance.category for d in drawn})
        emitted = (emission, *glows.values())
        emitters = emitters_of(geometry, texels, emitted, contents.lights, albedo)
        shining = [one.any(axis=1) for one in emitted]
        self._glows: NDArray[np.bool_] = np.logical_or.reduce(shining)
        self._around = Surroundings(
            scene=scene,
            faces=geometry.faces,
            two_sided=geometry.two_sided,
            paired=back_to_back_faces(geometry),
            places=layout.places,
            index=texels.index,
            sky=sky_picture(contents.environment),
            panes=panes(geometry),
            emitters=with_images(emitters, geometry, mirrors),
            mirrors=mirrors if mirrors.any() else mirrors[:0],
        )
        points = Points(
            positions=texels.positions,
            normals=texels.normals,
            faces=texels.faces,
            shifts=tile_shift(texels.rows, texels.columns),
        )
        self._views = ProbeViews.empty(len(self._spots), settings.probe_rays)
        look = stages.begin("probes", 0.03)
        stages.run(
            lambda first, end: self._views.look(self._around, self._spots, first, end),
            len(self._spots), settings.probe_rays, look,
        )  # fmt: skip
        self._probe_direct = [self._straight_at_probes(light) for light in contents.lights]
        return Samples(
            around=self._around,
            points=points,
            patches=patches_of(geometry, texels),
            albedo=albedo,
            emission=emission,
            glows=glows,
            texels=texels,
            owner=geometry.owner[texels.triangle],
        )

    def _draft(self, samples: Samples) -> BakedLight:
        """Return the light as one texel of each patch gets it, spread over the patch."""
        texels, of_texel = self._texels, samples.patches.of_texel
        chosen = samples.patches.middles(texels)
        index = np.full(texels.index.shape, -1, np.int32)
        index[texels.rows, texels.columns] = of_texel
        points = samples.points.part(chosen)
        few = Samples(
            around=replace(self._around, index=index),
            points=replace(points, shifts=tile_shift(
                texels.rows[chosen] // 4, texels.columns[chosen] // 4
            )),
            patches=Patches(
                of_texel=np.arange(len(chosen), dtype=np.int32), count=len(chosen)
            ),
            albedo=samples.patches.means(samples.albedo, np.ones(texels.count, bool)),
            emission=samples.emission[chosen],
            glows={name: glow[chosen] for name, glow in samples.glows.items()},
        )  # fmt: skip
        solver = Solver(few, self._snapshot.contents.lights, drafted(self._settings), self._stages)
        solver.begin()
        tiles = texels.tiles(chosen)
        # Of patches that share a tile one is averaged: what is at edges stays as it is.
        alone = np.bincount(tiles.places, minlength=1)[tiles.places] == 1
        for _ in range(DRAFT_SMOOTHING):
            # Few rays leave blotches, which are wider than what texels are averaged over.
            smooth = denoised(
                self._geometry, tiles, solver.bounced, solver.valid & alone, solver.nearness,
                self._stages.workers,
            )  # fmt: skip
            solver.bounced[alone] = smooth[alone]
        return self._result(solver, of_texel)

    def _straight_at_probes(self, light: Light) -> Floats | None:
        """Return (N, 4) float32, what probes get straight from a light that needs them for that."""
        if light.type == "directional":
            return None
        pattern = low_discrepancy_points(self._settings.light_rays)
        return straight_light(self._around.scene, light, self._spots, pattern)

    def _probes(self, solver: Solver, of_texel: NDArray[np.int32] | None) -> tuple[Floats, Floats]:
        """Return (L, N, 4) direct and (N, 4, 3 L) bounced light of the probes."""
        radiance = solver.radiance if of_texel is None else solver.radiance[of_texel]
        sky = SkyWindows(self._around.sky, self._around.panes)
        bounced = probe_light(self._views, radiance, sky, self._stages.workers)
        direct = np.zeros((len(solver.lights), len(self._spots), 4), dtype=np.float32)
        for place, straight in enumerate(self._probe_direct):
            if straight is not None:
                direct[place + 1] = straight
        unknown, grid = ~self._visibility.useful, self._grid
        bounced = dilated_grid(bounced, unknown, grid)
        direct = np.stack([dilated_grid(d[..., None], unknown, grid)[..., 0] for d in direct])
        return direct, bounced

    def _clear(self, light: Light | None) -> float:
        """Return how much of a light glass lets through, on average over the probes it reaches."""
        if light is None or light.type != "directional":
            return 1.0
        spots = self._spots[self._visibility.useful]
        towards = np.tile(-np.asarray(light.direction, np.float32), (len(spots), 1))
        never = np.full(len(spots), NEVER, np.float32)
        share = self._around.scene.share_that_passes(spots, towards, never)
        return float(share[share > 0.0].mean(dtype=np.float64)) if share.any() else 1.0

    def _result(self, solver: Solver, of_texel: NDArray[np.int32] | None = None) -> BakedLight:
        """Lay everything out as the renderer takes it.

        Parameters
        ----------
        of_texel : (texels,) int32 or None
            Which of the solver's points stands for each texel; None if each stands for itself.
        """
        texels, grid = self._texels, self._grid
        valid = solver.valid if of_texel is None else solver.valid[of_texel]
        known, columns = texel_light(
            solver, self._geometry, texels, valid, of_texel, self._stages.workers
        )
        probe_direct, probe_bounced = self._probes(solver, of_texel)
        layers = []
        for place, entry in enumerate(solver.lights):
            mine = slice(3 * place, 3 * place + 3)
            share = edges = None
            if entry.visibility is not None:
                rounded = np.rint(known[:, columns[place, "visibility"]] * 255.0)
                if of_texel is None:
                    edges = self._sun_edges(entry, valid)
                    marked = edges.index[texels.rows, texels.columns] >= 0
                    # Where light is partial, blocks are looked for.
                    rounded[marked] = np.clip(rounded[marked], 1.0, 254.0)
                share = self._map_of(rounded, np.uint8)
            layers.append(
                LightLayer(
                    light=entry.light,
                    direct=self._map_of(known[:, columns[place, "direct"]], np.float16),
                    bounced=self._map_of(known[:, mine], np.float16),
                    probe_direct=np.repeat(
                        probe_direct[place].reshape(*grid.shape, 4, 1), 3, axis=-1
                    ).astype(np.float16),
                    probe_bounced=probe_bounced[:, :, mine]
                    .reshape(*grid.shape, 4, 3)
                    .astype(np.float16),
                    visibility=share,
                    clear=self._clear(entry.light),
                    edges=edges,
                )
            )
        return BakedLight(
            fingerprint=fingerprint(self._snapshot, self._settings),
            charts=self._layout.charts,
            layers=tuple(layers),
            probes=grid,
            seen=self._seen(solver, of_texel),
        )

    def _seen(self, solver: Solver, of_texel: NDArray[np.int32] | None) -> NDArray[np.float16]:
        """Return (K, L, 3): the radiance that eyes see, but of shades, bulbs and screens.

        An exposure for what these light lets them be white.
        """
        texels = self._views.level(self._spots, self._visibility.useful)
        texels = texels[~self._glows[texels]]
        seen = solver.radiance[texels if of_texel is None else of_texel[texels]]
        return seen.reshape(len(texels), len(solver.lights), 3).astype(np.float16)

    def _sun_edges(self, entry: SolvedLight, valid: NDArray[np.bool_]) -> SunEdges:
        """Return where a directional light's shadows end; found once for all results."""
        assert entry.light is not None
        assert entry.mixed is not None
        found = self._edges.get(entry.light.name)
        if found is None:
            found = self._edges[entry.light.name] = sun_edges(
                self._geometry, self._around.scene, self._texels, self._layout.places,
                entry.light, entry.mixed[valid[entry.mixed]], self._stages.run,
            )  # fmt: skip
        return found

    def _map_of(self, values: Floats, kind: type[np.generic]) -> NDArray[Any]:
        texels = self._texels
        result: NDArray[Any] = np.zeros((*texels.index.shape, *values.shape[1:]), dtype=kind)
        result[texels.rows, texels.columns] = values
        return rounded(result) if kind is np.float16 else result
