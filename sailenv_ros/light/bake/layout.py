"""The place of every instance in the light map. From `StaticGeometry` to `Layout`.

Knows neither rays nor light.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.packing import STEP, packed
from sailenv_ros.light.bake.settings import BakeSettings
from sailenv_ros.light.bake.unwrap import Chart, unwrapped
from sailenv_ros.rays.static_geometry import StaticGeometry, StaticInstance
from sailenv_ros.types.baked_light import LightChart
from sailenv_ros.types.model import Model

__all__ = ["Layout", "laid_out"]

SIMPLE_TRIANGLES = 1000
"""Models of fewer triangles are boards and walls, whose large faces show fine shadows."""

MOST_TEXELS = 50_000
"""Greatest number of texels of a model of many triangles, unless its texels are as large as they
may be."""

MOST_LIT = 12_000_000
"""Greatest number of texels times layers of light: 8 bytes each, some 100 MB."""

COARSEST_STEP = 7
"""Greatest number of steps by which the texels of one model grow."""

BORDER = 3.0
"""Number of texels, about, that a piece's borders add to either side; they do not shrink."""

COARSER = 1.15
"""Growth of the texels until everything fits."""

COARSEST = 4.0
"""Growth of the texels up to which it is for the sake of `MOST_LIT`."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Layout:
    """The light map's plan.

    Attributes
    ----------
    side : int
        Of the map [texels].
    charts : dict of int to LightChart
        By instance id.
    places : (T, 3, 2) float32
        Of each triangle's corners in the map, x then y [texels]; texel (i, j) covers j to j + 1
        in x and i to i + 1 in y.
    """

    side: int
    charts: dict[int, LightChart]
    places: NDArray[np.float32]


def laid_out(
    geometry: StaticGeometry,
    settings: BakeSettings,
    visible_triangles: NDArray[np.bool_],
    report: Callable[[float], None] = lambda share: None,
    *,
    layers: int = 1,
) -> Layout:
    """Unwrap all models and pack their charts.

    Parameters
    ----------
    layers : int
        Of light, one for each light and one for the surroundings.
    visible_triangles : (T,) bool
        Triangles that are seen at all.
    """
    coarser, few = 1.0, math.isqrt(MOST_LIT // layers) // STEP * STEP
    while True:
        charts = _unwrapped_models(geometry, settings, visible_triangles, coarser, report)
        own = [charts[instance.model] for instance in geometry.instances]
        # Borders do not shrink with the texels: some scenes never fit into little memory.
        most = min(settings.max_map, few) if coarser < COARSEST else settings.max_map
        # The border keeps neighbours' texels out of look-ups that rounding moves by a hair.
        fit = packed([(chart.width + 1, chart.height + 1) for chart in own], most)
        if fit is not None:
            break
        coarser *= COARSER
    side, corners = fit
    places = np.zeros((geometry.triangle_count, 3, 2), dtype=np.float32)
    for instance, chart, corner in zip(geometry.instances, own, corners, strict=True):
        _place(places, instance, chart, corner)
    return Layout(
        side=side,
        places=places,
        charts={
            instance.id: LightChart(
                unwrapping=chart.unwrapping,
                offset=(x / side, y / side),
                scale=(chart.width / side, chart.height / side),
                world_from_body=instance.world_from_body,
            )
            for instance, chart, (x, y) in zip(geometry.instances, own, corners, strict=True)
        },
    )


def _unwrapped_models(
    geometry: StaticGeometry,
    settings: BakeSettings,
    visible_triangles: NDArray[np.bool_],
    coarser: float,
    report: Callable[[float], None],
) -> dict[Model, Chart]:
    users: dict[Model, list[StaticInstance]] = {}
    for instance in geometry.instances:
        users.setdefault(instance.model, []).append(instance)
    charts = {}
    for model, instances in users.items():
        seen = np.zeros(model.triangle_count, dtype=bool)
        for instance in instances:
            first = instance.first_triangle
            seen |= visible_triangles[first : first + model.triangle_count]
        largest = np.abs([instance.scale for instance in instances]).max(axis=0)
        charts[model] = _unwrapped(model, tuple(largest.tolist()), seen, settings, coarser)
        report(len(charts) / len(users))
    return charts


def _unwrapped(
    model: Model,
    scale: tuple[float, float, float],
    seen: NDArray[np.bool_],
    settings: BakeSettings,
    coarser: float,
) -> Chart:
    if model.triangle_count <= SIMPLE_TRIANGLES:
        return unwrapped(model, scale, coarser * settings.texel_m, seen)
    texel = coarser * settings.fine_texel_m
    step = 0
    while True:
        chart = unwrapped(model, scale, texel * COARSER**step, seen)
        if step == COARSEST_STEP or chart.width * chart.height <= MOST_TEXELS:
            return chart
        step += _steps_until_it_fits(chart, COARSEST_STEP - step)


def _steps_until_it_fits(chart: Chart, most: int) -> int:
    """Return by how many steps texels must grow, about; from 1 to `most`."""
    size = float(chart.width * chart.height)
    border = min(BORDER / math.sqrt(size / chart.pieces), 1.0)
    for step in range(1, most):
        if size * ((1.0 - border) / COARSER**step + border) ** 2 <= MOST_TEXELS:
            return step
    return most


def _place(
    places: NDArray[np.float32], instance: StaticInstance, chart: Chart, corner: tuple[int, int]
) -> None:
    first = instance.first_triangle
    size = np.array([chart.width, chart.height], dtype=np.float32)
    offset = np.array(corner, dtype=np.float32)
    for triangles, uvs in zip(chart.unwrapping.triangles, chart.unwrapping.uvs, strict=True):
        places[first : first + len(triangles)] = (uvs * size + offset)[triangles]
        first += len(triangles)
