"""The light that texels of a map show. From a `Solver` to columns of numbers, free of noise.

Knows neither where texels lie in a map nor how rays find light.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.denoise import denoised, dilated
from sailenv_ros.light.bake.solving import SolvedLight, Solver
from sailenv_ros.light.bake.texels import Texels
from sailenv_ros.rays.static_geometry import StaticGeometry

__all__ = ["texel_light"]

Floats = NDArray[np.float32]


def texel_light(
    solver: Solver,
    geometry: StaticGeometry,
    texels: Texels,
    valid: NDArray[np.bool_],
    of_texel: NDArray[np.int32] | None,
    workers: int,
) -> tuple[Floats, dict[tuple[int, str], int]]:
    """Return the light of texels, denoised and dilated, and what its columns hold.

    Parameters
    ----------
    valid : (texels,) bool
        False inside of something.
    of_texel : (texels,) int32 or None
        Which of the solver's points stands for each texel; None if each stands for itself.

    Returns
    -------
    light : (texels, K) float32
        First the bounced light of each light, three colours each.
    columns : dict of (int, str) to int
        Of the light with this number its `direct` and, if it is directional, `visibility`.
    """
    given = {
        (place, name): values
        for place, entry in enumerate(solver.lights)
        for name, values in (("direct", entry.direct), ("visibility", entry.visibility))
        if values is not None
    }
    rough = [
        key
        for key in given
        if of_texel is not None or (key[1] == "direct" and _is_rough(solver.lights[key[0]]))
    ]
    order = [*rough, *(key for key in given if key not in rough)]
    bounced = solver.bounced.shape[1]
    light = np.empty((len(solver.bounced), bounced + len(order)), np.float32)
    light[:, :bounced] = solver.bounced
    for column, key in enumerate(order, bounced):
        light[:, column] = given[key]
    nearness = solver.nearness
    if of_texel is not None:
        light, nearness = light[of_texel], nearness[of_texel]
    noisy = slice(0, bounced + len(rough))
    light[:, noisy] = denoised(
        geometry, texels, np.ascontiguousarray(light[:, noisy]), valid, nearness, workers
    )
    columns = {key: column for column, key in enumerate(order, bounced)}
    return dilated(geometry, texels, light, valid), columns


def _is_rough(entry: SolvedLight) -> bool:
    """Tell whether few rays made it: an area light's shadows are as soft as texels are fine."""
    return entry.light is not None and entry.light.type == "area"
