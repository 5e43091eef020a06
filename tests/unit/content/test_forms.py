"""Forms that furniture is made of."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_content.procedural.forms import lathe


def test_a_profile_that_comes_back_makes_a_ring() -> None:
    """Its hole is open: the surface is that of the four sides alone."""
    inner, outer, high, sides = 0.08, 0.1, 0.01, 400
    profile = [(inner, 0.0), (outer, 0.0), (outer, high), (inner, high), (inner, 0.0)]
    ring = lathe(profile, sides)
    corners = ring.positions[ring.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * np.linalg.norm(across, axis=1).sum()
    expected = 2.0 * np.pi * (outer**2 - inner**2 + high * (outer + inner))
    assert area == pytest.approx(expected, rel=1e-3)
