"""Objects that are not where their light was baked. From poses to changes and back to rays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.native.render_types import address
from sailenv_ros.rays.solid_models import SolidModel, SolidModels
from sailenv_ros.types.baked_light import LightChart
from sailenv_ros.types.model import Model

__all__ = ["Change", "PlacedInstance", "placed_instances", "ray_instances"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Change:
    """An object that was baked and moved or went, or that came.

    Attributes
    ----------
    id : int
        Of the instance.
    before, after : (4, 4) float64 or None
        Where it stands in the bake and now; None for nowhere.
    came : tuple or None
        Model and scale of an object that has no baked light.
    """

    id: int
    before: NDArray[np.float64] | None
    after: NDArray[np.float64] | None
    came: tuple[Model, tuple[float, float, float]] | None = None

    @property
    def key(self) -> tuple[int, bytes | None, object]:
        """Id, place and model: two changes of one bake with equal keys are one."""
        return self.id, None if self.after is None else self.after.tobytes(), self.came


@dataclass(frozen=True, eq=False, slots=True)
class PlacedInstance:
    """A shape where it stands: before the changes, after them, or both.

    Attributes
    ----------
    radiance : (6, C) float32 or None
        What its sides send out, see sent_light.py; None where it has a chart.
    """

    shape: SolidModel
    pose: NDArray[np.float64]
    chart: LightChart | None
    radiance: NDArray[np.float32] | None
    before: bool
    after: bool


def placed_instances(
    scene: BakedScene, change: Change, radiance: NDArray[np.float32] | None
) -> list[PlacedInstance]:
    """Return what a change takes away and puts there."""
    if change.came is not None:
        model, scale = change.came
        shape = scene.shape_of(model, scale, None)
        assert change.after is not None
        return [PlacedInstance(shape, change.after, None, radiance, False, True)]
    shape, chart = scene.shape(change.id), scene.baked.charts[change.id]
    things = []
    if change.before is not None:
        things.append(PlacedInstance(shape, change.before, chart, None, True, False))
    if change.after is not None:
        things.append(PlacedInstance(shape, change.after, chart, None, False, True))
    return things


def ray_instances(things: list[PlacedInstance]) -> tuple[NDArray[np.void], NDArray[np.float64]]:
    """Return (N,) RAY_INSTANCE, and (N, 6) float64 boxes around them; `things` keeps the memory."""
    poses = np.array([thing.pose for thing in things]).reshape(-1, 4, 4)
    rows, boxes = SolidModels([thing.shape for thing in things]).at(poses)
    for row, thing in zip(rows, things, strict=True):
        row["radiance_at"] = address(thing.radiance)
        if thing.chart is not None:
            row["chart"] = (*thing.chart.offset, *thing.chart.scale)
            row["has_chart"] = 1
        row["before"], row["after"] = thing.before, thing.after
    return rows, boxes
