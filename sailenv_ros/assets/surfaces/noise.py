"""Random fields that continue at the opposite edge, and the shapes that surfaces are cut by.

Generators in, (H, W) float32 arrays out. Knows no surface.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.surfaces.maps import Floats

__all__ = ["SIZE_PX", "banded", "blurred", "cloudy", "grid", "mixed", "ramp", "shifted"]

SIZE_PX = 1024
"""Edge length of all textures."""


def grid(tile_m: tuple[float, float]) -> tuple[Floats, Floats]:
    """Return x of each column (1, W) and y of each row (H, 1), at the pixels' centres [m]."""
    share = (np.arange(SIZE_PX, dtype=np.float32) + np.float32(0.5)) / np.float32(SIZE_PX)
    return share[np.newaxis, :] * np.float32(tile_m[0]), share[:, np.newaxis] * np.float32(
        tile_m[1]
    )


def blurred(rng: np.random.Generator, across_px: float, down_px: float | None = None) -> Floats:
    """Make noise whose features have about this size along columns and rows; mean 0, spread 1."""
    return _noise(rng, _low_pass(across_px, across_px if down_px is None else down_px))


def banded(rng: np.random.Generator, fine_px: float, coarse_px: float) -> Floats:
    """Make noise without features smaller or larger than these; mean 0, spread 1."""
    return _noise(rng, _low_pass(fine_px, fine_px) - _low_pass(coarse_px, coarse_px))


def cloudy(rng: np.random.Generator, falloff: float = 1.5) -> Floats:
    """Make noise with features of all sizes, larger ones stronger; mean 0, spread 1."""
    across, down = _frequencies()
    squared = across * across + down * down
    squared[0, 0] = np.inf
    return _noise(rng, squared ** np.float32(-0.5 * falloff))


def ramp(values: Floats, low: float, high: float) -> Floats:
    """Rise smoothly from 0 at `low` to 1 at `high`; `low` may be the larger."""
    share = np.clip((values - np.float32(low)) / np.float32(high - low), 0.0, 1.0)
    smooth: Floats = share * share * (np.float32(3.0) - np.float32(2.0) * share)
    return smooth


def mixed(first: NDArray[np.floating], second: NDArray[np.floating], share: Floats) -> Floats:
    """Mix two colours (3,) or pictures (H, W, 3) by a share (H, W) of the second."""
    start, end = np.asarray(first, np.float32), np.asarray(second, np.float32)
    picture: Floats = start + (end - start) * share[..., np.newaxis]
    return picture


def shifted(field: Floats, piece: NDArray[np.intp], rng: np.random.Generator) -> Floats:
    """Look at another part of a field in each piece.

    Parameters
    ----------
    field : (H, W) float32
    piece : (H, W) int
        Number of the piece that a pixel belongs to, from 0.
    """
    count = int(piece.max()) + 1
    down, across = rng.integers(0, SIZE_PX, (2, count))
    here = np.arange(SIZE_PX)
    rows = (here[:, np.newaxis] + down[piece]) % SIZE_PX
    columns = (here[np.newaxis, :] + across[piece]) % SIZE_PX
    picked: Floats = field.reshape(-1)[rows * SIZE_PX + columns]
    return picked


def _frequencies() -> tuple[Floats, Floats]:
    """Cycles per pixel of the spectrum's columns (1, W / 2 + 1) and rows (H, 1)."""
    from scipy import fft

    across = fft.rfftfreq(SIZE_PX).astype(np.float32)[np.newaxis, :]
    down = fft.fftfreq(SIZE_PX).astype(np.float32)[:, np.newaxis]
    return across, down


def _low_pass(across_px: float, down_px: float) -> Floats:
    across, down = _frequencies()
    # A Gaussian of this deviation in pixels has about twice it as the size of its features.
    factor = -2.0 * np.pi**2 * 0.25
    gain: Floats = np.exp(np.float32(factor * across_px**2) * across * across) * np.exp(
        np.float32(factor * down_px**2) * down * down
    )
    return gain


def _noise(rng: np.random.Generator, gain: Floats) -> Floats:
    """Shape white noise by a gain of its frequencies; periodic, as every Fourier series is."""
    from scipy import fft

    parts = rng.standard_normal((2, SIZE_PX, SIZE_PX // 2 + 1), dtype=np.float32)
    spectrum = (parts[0] + np.complex64(1j) * parts[1]) * gain
    spectrum[0, 0] = 0.0
    field: Floats = fft.irfft2(spectrum, s=(SIZE_PX, SIZE_PX))
    field = field.astype(np.float32, copy=False)
    return field / np.float32(field.std())
