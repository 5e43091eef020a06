"""The benchmark's copy of the tone curve is the renderer's."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.reference.curve import picture_of
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.lights import Environment
from tests.render.conftest import Render
from tests.support.tiny_scenes import snapshot_of


@pytest.mark.parametrize("radiance", [0.003, 0.02, 0.1, 0.4, 1.0, 3.0])
@pytest.mark.parametrize("stops", [-1.0, 0.5])
def test_radiance_becomes_the_same_picture(radiance: float, stops: float, render: Render) -> None:
    """A background of known radiance has the value that the benchmark's curve gives it."""
    colour = (radiance, radiance / 2.0, radiance / 3.0)
    surroundings = Environment(background="colour", background_colour=colour, exposure=stops)
    snapshot = snapshot_of([], environment=surroundings)
    camera = Camera(intrinsics=CameraIntrinsics(width=8, height=8))
    drawn = render(snapshot, camera, "rgb")["rgb"]
    expected = picture_of(np.array(colour), stops)
    assert np.abs(drawn.astype(int) - expected.astype(int)).max() <= 1
