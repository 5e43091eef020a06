"""The kernels of light maps do what the plain arithmetic does."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.native.light_maps import blur_directions, sum_texels
from sailenv_ros.render.scene import lightmap_compositing as plain
from sailenv_ros.render.scene import reflection_map
from tests.support import reference_blur


@pytest.mark.parametrize("shape", [(16, 24), (7, 5), (1, 1)])
@pytest.mark.parametrize("threads", [1, 3])
def test_layers_add_up_bit_for_bit(shape: tuple[int, int], threads: int) -> None:
    """Coloured and plain layers, in their order, as NumPy adds them."""
    random = np.random.default_rng(5)
    terms: list[plain.Term] = [
        (
            random.exponential(0.5, (*shape, *((3,) if number % 2 == 0 else ()))).astype(
                np.float16
            ),
            random.uniform(0.0, 4.0, 3).astype(np.float32),
        )
        for number in range(5)
    ]
    more = np.float32([0.1, -0.2, 0.0])
    shown = random.integers(0, 256, shape).astype(np.uint8)
    expected = plain.sum_texels(terms, more, shown)
    got = sum_texels(terms, more, shown, threads=threads)
    np.testing.assert_array_equal(got.view(np.uint16), expected.view(np.uint16))


def test_reflections_are_blurred_alike() -> None:
    """A map of random light, blurred for each roughness: to the precision of half numbers."""
    light = np.random.default_rng(1).exponential(1.0, (32, 32, 3)).astype(np.float32)

    def blur(*arrays: np.ndarray) -> None:  # type: ignore[type-arg]
        blur_directions(*arrays, threads=2)

    expected = reflection_map.prefilter(light, blur=reference_blur.blur_directions).astype(float)
    got = reflection_map.prefilter(light, blur=blur).astype(float)
    # A sample on the border of two texels may fall into either.
    assert np.quantile(np.abs(got - expected), 0.99) < 2e-3
    np.testing.assert_allclose(got.mean(), expected.mean(), rtol=1e-3)
