"""Arrays in few bytes come back bit by bit, whatever they hold; smooth ones take little."""

from __future__ import annotations

import tracemalloc
import zlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from sailenv_ros.light.bake.array_coding import coded, decoded, rounded

KINDS = (np.float16, np.uint8, np.int32, np.uint32, np.float32, np.float64)


@given(
    st.sampled_from(KINDS).flatmap(
        lambda kind: arrays.arrays(
            kind, arrays.array_shapes(min_dims=1, max_dims=5, min_side=0, max_side=5)
        )
    )
)
def test_every_array_comes_back(array: NDArray[Any]) -> None:
    same = decoded(coded(array))
    assert (same.dtype, same.shape) == (array.dtype, array.shape)
    assert same.tobytes() == array.tobytes()


def test_what_inflates_to_more_than_it_tells_takes_no_memory() -> None:
    bomb = b'["<f2", [4]]\n' + zlib.compress(bytes(10**8))
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match="no coded array"):
            decoded(np.frombuffer(bomb, np.uint8))
        assert tracemalloc.get_traced_memory()[1] < 10**6
    finally:
        tracemalloc.stop()


def test_light_is_rounded_to_the_nearest_of_nine_bits() -> None:
    """At most 0.2 % off where half precision is relative, and never infinite."""
    every = np.arange(0x7C00, dtype=np.uint16).view(np.float16)
    near = rounded(every)
    assert not (near.view(np.uint16) & 3).any()
    assert np.isfinite(near).all()
    normal = every.astype(float)[0x400:-4]
    assert (np.abs(near.astype(float)[0x400:-4] / normal - 1.0) <= 2.0**-9 + 1e-12).all()
    assert (rounded(near) == near).all()


def test_smooth_light_takes_a_quarter() -> None:
    """A wall's light that falls off to one side, in three colours, with noise of a thousandth."""
    rng = np.random.default_rng(4)
    fall = np.linspace(1.0, 0.1, 256)[None, :, None] * np.array([0.9, 0.8, 0.6])
    light = (fall * rng.normal(1.0, 1e-3, (256, 256, 1))).astype(np.float16)
    assert len(coded(light)) < light.nbytes / 4


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"[]\n",
        b'["<f2", [4]]\nno',
        b'["<f2", [4]]\n',
        b'["|O", [4]]\n' + zlib.compress(bytes(32)),
        b'["<f2", [-4, -1]]\n' + zlib.compress(bytes(8)),
        b'["<f2", [1.5]]\n' + zlib.compress(bytes(2)),
        b'["<f2", [4]]\n' + zlib.compress(bytes(7)),
        b'["<f2", [4]]\n' + zlib.compress(bytes(10**7)),
        b'["<f8", [1000000, 1000000]]\n' + zlib.compress(bytes(8)),
    ],
)
def test_other_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match="no coded array"):
        decoded(np.frombuffer(data, np.uint8))
