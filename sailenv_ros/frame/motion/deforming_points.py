"""Single points of surfaces that deform: where they are at an instant, and where at rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.surface_kernels import surface_points
from sailenv_ros.rays.opaque_models import surface_between
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.instance_states import InstanceStates

__all__ = ["at_instant", "at_rest"]

Doubles = NDArray[np.float64]


def at_rest(points: Doubles, instances: NDArray[np.uint16], states: InstanceStates) -> Doubles:
    """Return where points of surfaces are at rest.

    Parameters
    ----------
    points : (N, 3) float64
        In their instances' own frames at an instant [m].
    instances : (N,) uint16
    states : InstanceStates
        Of that instant.

    Returns
    -------
    points : (N, 3) float64
        The same but for those of instances that deform; nan where no surface is near.
    """
    return _moved(points, instances, states, to_rest=True)


def at_instant(points: Doubles, instances: NDArray[np.uint16], states: InstanceStates) -> Doubles:
    """Return where points of surfaces are at an instant, from where they are at rest; `at_rest`."""
    return _moved(points, instances, states, to_rest=False)


def _moved(
    points: Doubles, instances: NDArray[np.uint16], states: InstanceStates, *, to_rest: bool
) -> Doubles:
    there = set(np.unique(instances).tolist())
    surfaces = []
    for key, shape in states.deformations.items():
        if key in there:
            x, y, z = states.scales[states.row(key)].tolist()
            ways = (shape, shape.model) if to_rest else (shape.model, shape)
            surfaces.append(surface_between(key, (x, y, z), *ways))
    if not surfaces:
        return points
    moved = points.astype(np.float32)[None]
    surface_points(
        *(moved, np.ascontiguousarray(instances[None]), surfaces, moved),
        relative=False,
        threads=thread_count(),
    )
    deforming = np.isin(instances, [surface.instance_id for surface in surfaces])
    return np.where(deforming[:, None], moved[0].astype(np.float64), points)
