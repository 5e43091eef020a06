"""Baked light as it would be if some objects stood elsewhere. From `BakedScene` to `BakedLight`.

Only rays that meet what moved, before or after, are followed: the difference between what they
met and what they meet now is added to what was baked. A surface that was hidden, and what moved
itself, gets its light again. Results do not depend on the number of threads.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.light_probes import probe_positions
from sailenv_ros.light.bake.settings import INSIDE_SHARE
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.layer_updates import DirectDelta, LayerUpdates
from sailenv_ros.light.relight.moved_surfaces import moved_surfaces
from sailenv_ros.light.relight.quality import Quality
from sailenv_ros.light.relight.ray_world import ray_world
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.native.ray_types import RAY_LIGHT
from sailenv_ros.native.relight_kernels import (
    direct_light_delta,
    gather_change,
    gather_probe_change,
    light_of_probes,
    smooth_change,
)
from sailenv_ros.rays.ray_patterns import (
    fibonacci_sphere,
    low_discrepancy_points,
    sequence_points,
)
from sailenv_ros.types.baked_light import BakedLight, LightChart
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.light_shapes import light_record
from sailenv_ros.types.model import Model

__all__ = ["relit"]

Floats = NDArray[np.float32]

LEAST_KNOWN = 0.004
"""Share of what most patches get below which nothing is known of what others would get."""


def relit(
    scene: BakedScene,
    changes: Sequence[Change],
    quality: Quality,
    *,
    threads: int,
    painted: Mapping[int, Model] | None = None,
) -> BakedLight:
    """Return the light of a scene in which some objects stand elsewhere.

    Parameters
    ----------
    scene : BakedScene
        As it was baked.
    changes : sequence of Change
        All that is different now.
    quality : Quality
    painted : mapping of int to Model or None
        Models of the same shape with other materials, by instance id.
    """
    return _Relighting(scene, changes, quality, threads, painted or {}).run()


class _Relighting:
    """One set of changes; what the steps share."""

    def __init__(
        self,
        scene: BakedScene,
        changes: Sequence[Change],
        quality: Quality,
        threads: int,
        painted: Mapping[int, Model],
    ) -> None:
        self._scene, self._changes, self._threads = scene, changes, threads
        self._quality = quality
        self._layers = scene.baked.layers
        self._lights = [layer.light for layer in self._layers]
        area = [(n, one) for n, one in enumerate(self._lights) if one and one.type == "area"]
        self._area, self._area_lights = [n for n, _ in area], [light for _, light in area]
        self._surfaces = surfaces = moved_surfaces(scene, changes)
        self._positions, self._normals = surfaces.positions, surfaces.normals
        self._patch_positions = surfaces.patch_positions
        self._patch_normals = surfaces.patch_normals
        self._wanted = surfaces.wanted
        self._bounces = quality.bounces if painted else 0
        self._far = quality.with_far or bool(painted)
        self._albedo, self._emission = scene.patches.albedo, scene.patches.emission
        self._before, self._after = scene.sent, scene.sent.copy()
        if painted:
            self._albedo, self._emission = scene.looks_with(painted)
            self._before = scene.sent.copy()
            self._after = scene.radiance(
                scene.irradiance, scene.direct, self._albedo, self._emission
            )
        self._world = ray_world(scene, changes, self._before, self._after)
        self._rays = self._world.record

    def run(self) -> BakedLight:
        """Do everything."""
        quality = self._quality
        found, change, area = self._gather(self._wanted, quality.first_rays or quality.rays)
        # Where surfaces were hidden, direct light is worked out anew, too.
        irradiance, direct = self._scene.irradiance.copy(), self._scene.direct.copy()
        _take(irradiance, found, change)
        self._take_area(direct, found, area)
        deltas = self._direct_deltas(found, direct)
        self._send_out(irradiance, direct)
        if quality.first_rays:
            wanted = np.where(found == 2, 2, self._wanted)
            found, change, area = self._gather(wanted, quality.rays)
        found_far, change, far, near = self._bounced(found, change, direct)
        updates = LayerUpdates(
            self._layers, self._area, self._surfaces.texels(), self._surfaces.patches(),
            self._threads,
        )  # fmt: skip
        if quality.by_texels:
            layers = [
                updates.with_direct(layer, deltas.get(number))
                for number, layer in enumerate(updates.spread(found_far, change, area, {}))
            ]
        else:
            layers = updates.spread(found_far, change, area, deltas)
        layers = updates.with_probes(layers, far, near)
        return replace(self._scene.baked, layers=tuple(layers), charts=self._charts(), checksum="")

    def _send_out(self, irradiance: Floats, direct: Floats) -> None:
        self._after[:] = self._scene.radiance(
            np.maximum(irradiance, 0.0), direct, self._albedo, self._emission
        )

    def _bounced(
        self, found: NDArray[np.uint8], change: Floats, direct: Floats
    ) -> tuple[NDArray[np.uint8], Floats, Floats, Floats]:
        """Add what comes from surfaces that became brighter or darker; also by further bounces."""
        share = self._share_of_probes() if self._bounces else None
        for left in range(self._bounces, -1, -1):
            far, near = self._probe_change()
            found_far, changed = found.copy(), change.copy()
            if self._far:
                self._add_far(found_far, changed, far, share)
            if left:
                irradiance = self._scene.irradiance.copy()
                _take(irradiance, found_far, changed)
                self._send_out(irradiance, direct)
        return found_far, changed, far, near

    def _share_of_probes(self) -> Floats:
        """Return (P, 1): what patches get by the bake, over what they get through the probes.

        Probes within and behind surfaces know nothing, and four numbers are not all directions:
        near walls and in corners light that comes by the probes falls short.
        """
        before, after = self._before.copy(), self._after.copy()
        self._after[:], self._before[:] = before, 0.0
        total, _ = self._probe_change()
        self._before[:], self._after[:] = before, after
        by_probes = self._of_probes(total, self._patch_positions, self._patch_normals)
        # What the sky gives straight is no light of surfaces.
        lamps = [n for n, light in enumerate(self._lights) if light is not None]
        channels = [3 * n + colour for n in lamps for colour in range(3)]
        known = self._scene.irradiance[:, channels].sum(axis=1)
        guessed = by_probes[:, channels].sum(axis=1)
        least = LEAST_KNOWN * float(np.percentile(known, 90)) if known.any() else np.inf
        share = np.where(guessed > least, known / np.maximum(guessed, 1e-12), 1.0)
        return np.clip(share, 0.25, 4.0).astype(np.float32)[:, None]

    # -- what is there -----------------------------------------------------------------------

    def _charts(self) -> dict[int, LightChart]:
        charts = dict(self._scene.baked.charts)
        for change in self._changes:
            if change.came is not None:
                continue
            if change.after is None:
                charts.pop(change.id, None)
            else:
                charts[change.id] = replace(charts[change.id], world_from_body=change.after)
        return charts

    # -- light ---------------------------------------------------------------------------------

    def _gather(
        self, wanted: NDArray[np.integer], rays: int
    ) -> tuple[NDArray[np.uint8], Floats, Floats]:
        """Gather at all patches, and smooth what was found."""
        if not self._changes:
            patches = len(wanted)
            empty = np.zeros((patches, len(self._area)), np.float32)
            return np.zeros(patches, np.uint8), np.zeros_like(self._before), empty
        lights = np.concatenate(
            [np.zeros(0, RAY_LIGHT), *(light_record(light) for light in self._area_lights)]
        )
        shots = sequence_points(self._quality.area_rays)
        found, change, area, nearness = gather_change(
            self._rays, self._patch_positions, self._patch_normals, wanted.astype(np.uint8),
            low_discrepancy_points(rays), lights, shots, self._quality.least,
            inside_share=INSIDE_SHARE, threads=self._threads,
        )  # fmt: skip
        # Both in one go: they share their neighbours.
        smooth_found, both = smooth_change(
            self._surfaces.patches(), self._quality.smoothing, found, nearness,
            np.concatenate([change, area], axis=1), threads=self._threads,
        )  # fmt: skip
        channels = change.shape[1]
        change, area = (np.ascontiguousarray(part) for part in np.split(both, [channels], axis=1))
        return smooth_found, change, area

    def _take_area(self, direct: Floats, found: NDArray[np.uint8], area: Floats) -> None:
        for place, number in enumerate(self._area):
            column = direct[:, number : number + 1]
            _take(column, found, area[:, place : place + 1])
            np.maximum(column, 0.0, out=column)

    def _direct_deltas(self, found: NDArray[np.uint8], direct: Floats) -> dict[int, DirectDelta]:
        """Find what changes of lamps and sun, and bring means of patches up to date.

        Returns
        -------
        deltas : dict of int to tuple
            By layer: state, light and share of it that arrives, of texels or of patches.
        """
        patches, deltas = self._scene.patches, {}
        by_texels = self._quality.by_texels
        places = (
            (self._positions, self._normals, patches.of_texel)
            if by_texels
            else (
                self._patch_positions,
                self._patch_normals,
                np.arange(len(patches.size), dtype=np.int32),
            )
        )
        for number, light in enumerate(self._lights):
            if light is None or light.type == "area" or not self._changes:
                continue
            state, value, share = direct_light_delta(
                self._rays, light_record(light), *places,
                found, sequence_points(self._quality.light_rays), threads=self._threads,
            )  # fmt: skip
            if by_texels:
                old = self._layers[number].direct.reshape(-1)[self._scene.places].astype(np.float32)
            else:
                old = direct[:, number]
            new = np.where(state == 2, value, old + value)
            difference = np.where(state > 0, np.maximum(new, 0.0) - old, 0.0)
            if by_texels:
                difference = patches.means(difference)
            direct[:, number] = np.maximum(direct[:, number] + difference, 0.0)
            deltas[number] = state, value, share
        return deltas

    def _probe_change(self) -> tuple[Floats, Floats]:
        """Return (Z, Y, X, 4, C) float32 twice: see `gather_probe_change`."""
        grid = self._scene.baked.probes
        points = probe_positions(grid)
        far, near = gather_probe_change(
            self._rays, points, fibonacci_sphere(self._quality.probe_rays),
            with_far=self._far, threads=self._threads,
        )  # fmt: skip
        near[self._inside(points)] = 0.0
        shape = (*grid.shape, 4, far.shape[-1])
        return far.reshape(shape), near.reshape(shape)

    def _inside(self, points: Floats) -> NDArray[np.bool_]:
        """Return which points lie in the box of something that changes: nothing is known there."""
        inside = np.zeros(len(points), bool)
        for thing in self._world.changed:
            tree = thing.shape.tree
            inverse = invert(thing.pose)
            own = points @ inverse[:3, :3].T + inverse[:3, 3]
            inside |= ((own > tree.low) & (own < tree.high)).all(axis=1)
        return inside

    def _of_probes(self, probes: Floats, points: Floats, normals: Floats) -> Floats:
        grid = self._scene.baked.probes
        return light_of_probes(
            np.ascontiguousarray(probes), grid.origin_m, grid.spacing_m, points, normals,
            threads=self._threads,
        )  # fmt: skip

    def _add_far(
        self, found: NDArray[np.uint8], change: Floats, far: Floats, share: Floats | None
    ) -> None:
        """Add what comes from surfaces whose own light has changed, where it is seen."""
        light = self._of_probes(far, self._patch_positions, self._patch_normals)
        if share is not None:
            light *= share
        seen = np.abs(light).sum(axis=1) > self._quality.least_far * self._scene.brightest
        chosen = seen & (found < 2) & (self._wanted == 1)
        change[chosen] += light[chosen]
        found[chosen] = 1


def _take(values: Floats, found: NDArray[np.uint8], change: Floats) -> None:
    """Add what has changed, and replace what was computed again."""
    values[found == 1] += change[found == 1]
    values[found == 2] = change[found == 2]
