"""The kernels of lenses: the same bytes on every instruction set and any number of threads."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, NativeLibraryError
from sailenv_ros.native.lens_models import (
    lens_models,
    lens_reach,
    padded_coefficients,
    project_points,
    unproject_places,
)
from sailenv_ros.native.library import load_library, using_instruction_set

COEFFICIENTS: dict[str, tuple[float, ...]] = {
    "plumb_bob": (-0.2868, 0.0853, -0.0007, 0.0006, -0.0101),
    "rational_polynomial": (0.6, -0.03, 4e-4, -6e-4, 1e-3, 0.95, 0.03, -4e-3, 1e-3, 0.0, 2e-3, 0.0),
    "equidistant": (0.0035, 0.0007, -0.002, 0.0002),
    "double_sphere": (-0.17, 0.59),
    "mei": (1.04, -0.2, 0.045, 4e-4, -3e-4),
}


@pytest.mark.parametrize("name", [*COEFFICIENTS, "equirectangular", "orthographic"])
def test_bytes_depend_on_nothing_but_the_numbers(name: str) -> None:
    """Places all over the plane, and points all around the camera."""
    rng = np.random.default_rng(5)
    places, points = rng.uniform(-2.0, 2.0, (5000, 2)), rng.normal(0.0, 1.0, (5000, 3))
    model, given = lens_models()[name].number, COEFFICIENTS.get(name, ())
    limit = lens_reach(model, given).angle_rad
    assert 0.5 < limit <= math.pi
    found = set()
    for instruction_set in load_library().instruction_sets:
        with using_instruction_set(instruction_set):
            for threads in (1, 3):
                numbers = model, padded_coefficients(given), limit
                rays = unproject_places(*numbers, places, threads=threads)
                seen = project_points(*numbers, points, threads=threads)
                assert np.isfinite(seen).mean() > 0.05
                assert np.isfinite(rays).mean() > 0.05
                found.add((rays.tobytes(), seen.tobytes()))
    assert len(found) == 1


def test_what_is_no_model_is_refused() -> None:
    """A number that the table has not, and arrays of another kind."""
    none = padded_coefficients(())
    with pytest.raises(NativeLibraryError, match="refused its arguments"):
        unproject_places(len(lens_models()), none, 1.0, np.zeros((3, 2)), threads=1)
    with pytest.raises(InvalidRequest, match="places must be"):
        unproject_places(0, none, 1.0, np.zeros((3, 3)), threads=1)
    with pytest.raises(InvalidRequest, match="coefficients must be"):
        project_points(0, none[:4], 1.0, np.zeros((3, 3)), threads=1)
