"""Drives the kernels of baking with input that nobody should give; see hostile_input.py."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sailenv_ros.native.bake_types import Emitters, LitPoints, MappedTriangles, SkyWindows, TexelMap
from sailenv_ros.native.cluster_kernels import seen_indices
from sailenv_ros.native.gather_kernels import (
    emitter_rays,
    emitter_weights,
    hemisphere_rays,
    pane_rays,
    sky_by_chance,
    sky_by_choice,
    weights_within_cones,
)
from sailenv_ros.native.light_kernels import (
    direct_light,
    light_rays,
    light_samples,
    rectangle_form_factors,
)
from sailenv_ros.native.ray_types import RAY_LIGHT
from sailenv_ros.native.render_types import CLUSTER
from sailenv_ros.native.surface_light import (
    add_radiance_met,
    hand_on,
    mean_radiance_met,
    met_texels,
    patch_sources,
    probe_radiance,
)
from sailenv_ros.native.texel_kernels import (
    BLOCK_POINTS,
    bordered_blocks,
    denoise_texels,
    dilate_texels,
    nearest_triangles,
    texel_stand_ins,
)
from tests.unit.native.hostile_numbers import NUMBERS, THREADS, wild_floats

__all__ = ["DRIVERS"]


def wild_texels(rng: np.random.Generator, side: int, count: int) -> TexelMap:
    """Make a light map whose texels have places that are no places, and owners at will."""
    index = rng.integers(-2, 2 * count + 2, (side, side)).astype(np.int32)
    rows, columns, owners = rng.integers(0, side, (3, count)).astype(np.int32)
    return TexelMap(index, rows, columns, owners % 3, *(wild_floats(rng, 3, count, 3)))


def drive_texels() -> None:
    """Maps that name texels that are none, corners and values that are no numbers."""
    rng = np.random.default_rng(5)
    for side, count in ((1, 1), (3, 5), (9, 40)):
        texels = wild_texels(rng, side, count)
        values, valid = wild_floats(rng, count, 17), rng.random(count) < 0.5
        for threads in THREADS:
            denoise_texels(texels, values, valid, wild_floats(rng, count), threads=threads)
        dilate_texels(texels, values, valid, 3)
        texel_stand_ins(texels, valid, 3)
        bordered_blocks(texels, wild_floats(rng, count, BLOCK_POINTS, BLOCK_POINTS))
        triangles = rng.integers(0, 7, count).astype(np.int32)
        nearest_triangles(texels, triangles, wild_floats(rng, 7, 3, 2), np.arange(count))


def drive_gathering() -> None:
    """Points, windows and lamps at places that are no places; rays that met anything at all."""
    rng = np.random.default_rng(6)
    for count, rays in ((0, 4), (1, 1), (50, 16)):
        points = LitPoints(*wild_floats(rng, 3, count, 3), wild_floats(rng, count, 2))
        sky = SkyWindows(wild_floats(rng, 3, 5, 3), wild_floats(rng, 2, 4, 3))
        pattern, lamps = wild_floats(rng, rays, 2), Emitters(wild_floats(rng, 2, 4))
        hemisphere_rays(points, pattern)
        directions = wild_floats(rng, count, rays, 3)
        texels = rng.integers(-9, 9, (count, rays)).astype(np.int32)
        clear = wild_floats(rng, count, rays)
        light = sky_by_chance(points, sky, directions, texels, clear, shots=4)
        point, _, towards = pane_rays(points, wild_floats(rng, 4, 3), pattern)
        seen = point, towards, wild_floats(rng, len(point))
        sky_by_choice(points, sky, seen, shots=4, others=rays, light=light)
        point, _, towards = emitter_rays(points, wild_floats(rng, 4), pattern)
        emitter_weights(points, lamps, point, towards, shots=4, others=rays)
        weights_within_cones(points, lamps, directions, texels, shots=4)
        rectangle_form_factors(
            rng.choice(np.array(NUMBERS), (4, 3)), rng.choice(np.array(NUMBERS), 3),
            *wild_floats(rng, 2, count, 3),
        )  # fmt: skip


def drive_direct_light() -> None:
    """Lights of any kind and none, of numbers that are none."""
    rng = np.random.default_rng(9)
    light = np.zeros(1, RAY_LIGHT)
    for kind in range(-1, 5):
        for row in (light["lamp"], light):
            for name in row.dtype.names or ():
                if name not in ("kind", "lamp"):
                    row[name] = wild_floats(rng, *row[name].shape)
        light["lamp"]["kind"] = kind
        for count, rays in ((0, 4), (1, 1), (50, 16)):
            points = LitPoints(*wild_floats(rng, 3, count, 3), wild_floats(rng, count, 2))
            pattern = wild_floats(rng, rays, 2)
            light_samples(light, points, pattern)
            light_rays(light, points, pattern)
            direct_light(light, points, pattern, wild_floats(rng, count, rays))


def drive_surface_light() -> None:
    """Triangles and texels that are none, places that are no places, patches without texels."""
    rng = np.random.default_rng(7)
    triangles = MappedTriangles(
        wild_floats(rng, 6, 3), rng.random(6) < 0.5, rng.integers(-2, 9, 6).astype(np.int32),
        rng.integers(-2, 9, (6, 3)).astype(np.int32), wild_floats(rng, 6, 3, 2),
        rng.integers(-1, 9, (3, 5)).astype(np.int32),
    )  # fmt: skip
    sky = SkyWindows(wild_floats(rng, 3, 5, 3), wild_floats(rng, 0, 4, 3))
    for count, rays in ((0, 4), (1, 1), (40, 16)):
        triangle = rng.integers(-3, 9, rays).astype(np.int32)
        second, third = wild_floats(rng, 2, rays)
        met_texels(triangles, triangle, second, third, wild_floats(rng, rays, 3))
        texels = rng.integers(-9, 30, (count, rays)).astype(np.int32)
        radiance, clear = wild_floats(rng, 9, 6), wild_floats(rng, count, rays)
        mean_radiance_met(texels, radiance)
        for threads in THREADS:
            directions = wild_floats(rng, rays, 3)
            probe_radiance(directions, texels, clear, sky, radiance, threads=threads)
        bounds = np.array([0, count // 2, count // 2, count])
        turns = np.array([1, 3, max(count, 1)])
        members, met = np.arange(count, dtype=np.int32), np.zeros(count, np.int32)
        ends, sources = patch_sources(members, bounds, texels, met, turns)
        hand_on(ends, sources + 1, wild_floats(rng, 3, 16), threads=THREADS[1])
    point, texel = rng.integers(0, 5, (2, 30)).astype(np.int32)
    add_radiance_met(
        point, texel, wild_floats(rng, 30), wild_floats(rng, 5, 3), wild_floats(rng, 5, 3)
    )  # fmt: skip


def drive_clusters() -> None:
    """Spheres and cones that are none, eyes that are nowhere."""
    rng = np.random.default_rng(8)
    clusters = np.zeros(4, CLUSTER)
    clusters["first_index"], clusters["index_count"] = np.arange(4) * 3, 3
    for name in ("centre", "radius", "axis", "cosine"):
        clusters[name] = rng.choice(np.array(NUMBERS), clusters[name].shape)
    indices = np.arange(12, dtype=np.uint32)
    with np.errstate(all="ignore"):
        for parts in ([], [1], [1, 0]):
            seen_indices(
                np.array(parts, np.intp), clusters, np.array([[0, 2, 6], [2, 2, 6]]),
                rng.choice(np.array(NUMBERS), (2, 4, 4)), rng.choice(np.array(NUMBERS), (2, 3)),
                np.array([True, False]), indices, indices, np.array([True, False]),
            )  # fmt: skip


DRIVERS: tuple[Callable[[], None], ...] = (
    drive_texels,
    drive_gathering,
    drive_direct_light,
    drive_surface_light,
    drive_clusters,
)
