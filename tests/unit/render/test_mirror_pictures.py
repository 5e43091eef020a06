"""Borders of flat mirrors: what a mirror shows, and beside it what is there without it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.render.picture.mirror_pictures import reflect
from sailenv_ros.render.scene.flat_mirrors import SeenMirror
from tests.support.tiny_scenes import camera_at

WIDTH, HEIGHT, EDGE, BESIDE = 16, 12, 8, 0.2
SHOWN = 0.4


def halves(ids: NDArray[Any]) -> NDArray[np.float32]:
    """Return samples of a surface 3 m away, everywhere that of its column."""
    return np.stack([np.full(ids.shape, 3.0), ids], axis=-1).astype(np.float32)


@pytest.mark.parametrize("at_border", [0.9, 0.1, 5.0], ids=["as_beside", "darker", "brighter"])
def test_a_border_has_the_mean_of_both_sides(at_border: float) -> None:
    """Whatever the mirror was drawn as before in the pixel: its neighbours need not know."""
    camera = camera_at(width=WIDTH, height=HEIGHT)
    mirror = SeenMirror(
        instance_id=1,
        normal=np.array((-1.0, 0.0, 0.0)),
        point=np.array((3.0, 0.0, 0.0)),
        tint=np.ones(3, np.float32),
        window=(slice(0, HEIGHT), slice(0, WIDTH)),
        camera=camera,
        only=np.ones(1, bool),
    )
    ids = np.broadcast_to(np.where(np.arange(WIDTH) >= EDGE, 1, 2), (HEIGHT, WIDTH))
    # Of the pixel at the border the left sample belongs to the other side: a quarter.
    closer = np.arange(2 * WIDTH + 1) > 2 * EDGE
    samples = np.broadcast_to(np.where(closer, 1, 2), (2 * HEIGHT + 1, 2 * WIDTH + 1))
    radiance = np.full((HEIGHT, WIDTH, 4), BESIDE, np.float16)
    radiance[:, EDGE:, :3] = 0.9
    radiance[:, EDGE, :3] = 0.25 * BESIDE + 0.75 * at_border
    shown = np.full((HEIGHT, WIDTH, 4), SHOWN, np.float16)
    reflect([mirror], camera, radiance, halves(ids), lambda *_: shown, lambda _: halves(samples))
    expected = np.where(np.arange(WIDTH) < EDGE, BESIDE, SHOWN)
    expected[EDGE] = 0.25 * BESIDE + 0.75 * SHOWN
    np.testing.assert_allclose(
        radiance[..., 0], np.broadcast_to(expected, (HEIGHT, WIDTH)), rtol=2e-3
    )
