"""A convnet of two layers of filters and two of weights, trained by Adam; NumPy alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["MOST_CLASSES", "PATCH_PX", "SmallConvNet"]

PATCH_PX = 33
MOST_CLASSES = 256

FILTERS = (16, 32)
SIZES = (5, 3)
STRIDE = 2
HIDDEN = 128

RATE, BETA1, BETA2, EPSILON = 1e-3, 0.9, 0.999, 1e-8
"""Of Adam: D. Kingma and J. Ba (ICLR 2015)."""

Array = NDArray[np.float32]


class SmallConvNet:
    """Scores of patches, and steps that make them better.

    Parameters
    ----------
    seed : int
        Of the first weights: He's (ICCV 2015); those of the scores are 0.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        channels, side = 3, PATCH_PX
        self.weights: dict[str, Array] = {}
        for number, (count, size) in enumerate(zip(FILTERS, SIZES, strict=True)):
            self._layer(rng, f"filters{number}", channels * size**2, count)
            channels, side = count, (side - size) // STRIDE + 1
        self._layer(rng, "hidden", channels * side**2, HIDDEN)
        self._layer(None, "scores", HIDDEN, MOST_CLASSES)
        self._first = {name: np.zeros_like(value) for name, value in self.weights.items()}
        self._second = {name: np.zeros_like(value) for name, value in self.weights.items()}
        self._steps = 0

    def scores(self, patches: Array) -> Array:
        """Return (N, MOST_CLASSES) float32 of (N, PATCH_PX, PATCH_PX, 3) patches."""
        return self._forward(patches)[-1]

    def loss(self, patches: Array, labels: NDArray[np.int64]) -> float:
        """Return the mean cross-entropy of labels (N,) [nats]."""
        shares = _softmax(self.scores(patches))
        return float(-np.log(shares[np.arange(len(labels)), labels] + 1e-12).mean())

    def step(self, patches: Array, labels: NDArray[np.int64]) -> None:
        """Learn from one batch."""
        self._steps += 1
        for name, slope in self.gradients(patches, labels).items():
            first, second = self._first[name], self._second[name]
            first += (1.0 - BETA1) * (slope - first)
            second += (1.0 - BETA2) * (slope**2 - second)
            scale = np.sqrt(1.0 - BETA2**self._steps) / (1.0 - BETA1**self._steps)
            self.weights[name] -= RATE * scale * first / (np.sqrt(second) + EPSILON)

    def gradients(self, patches: Array, labels: NDArray[np.int64]) -> dict[str, Array]:
        """Return the derivative of `loss` by each weight."""
        columns0, map0, columns1, map1, hidden, scores = self._forward(patches)
        slope = _softmax(scores)
        slope[np.arange(len(labels)), labels] -= 1.0
        slope /= len(labels)
        found: dict[str, Array] = {}
        flat = map1.reshape(len(map1), -1)
        slope = self._back(found, "scores", hidden, slope) * (hidden > 0.0)
        slope = self._back(found, "hidden", flat, slope).reshape(map1.shape) * (map1 > 0.0)
        slope = self._back(found, "filters1", columns1, slope)
        slope = _folded(slope, map0.shape, SIZES[1]) * (map0 > 0.0)
        self._back(found, "filters0", columns0, slope)
        return found

    # -- inside ----------------------------------------------------------------------------

    def _layer(self, rng: np.random.Generator | None, name: str, inputs: int, outputs: int) -> None:
        weights = np.zeros((inputs, outputs))
        if rng is not None:
            weights = rng.normal(0.0, np.sqrt(2.0 / inputs), weights.shape)
        self.weights[name] = weights.astype(np.float32)
        self.weights[f"{name} bias"] = np.zeros(outputs, np.float32)

    def _times(self, inputs: Array, name: str) -> Array:
        product: Array = inputs @ self.weights[name] + self.weights[f"{name} bias"]
        return product

    def _forward(self, patches: Array) -> tuple[Array, ...]:
        columns0 = _unfolded(patches - np.float32(0.5), SIZES[0])
        map0 = self._times(columns0, "filters0").clip(0.0, None)
        columns1 = _unfolded(map0, SIZES[1])
        map1 = self._times(columns1, "filters1").clip(0.0, None)
        hidden = self._times(map1.reshape(len(map1), -1), "hidden").clip(0.0, None)
        return columns0, map0, columns1, map1, hidden, self._times(hidden, "scores")

    def _back(self, found: dict[str, Array], name: str, inputs: Array, slope: Array) -> Array:
        """Keep the derivatives by a layer's weights; return those by its inputs."""
        rows, slopes = inputs.reshape(-1, inputs.shape[-1]), slope.reshape(-1, slope.shape[-1])
        found[name], found[f"{name} bias"] = rows.T @ slopes, slopes.sum(axis=0)
        before: Array = slope @ self.weights[name].T
        return before


def _unfolded(maps: Array, size: int) -> Array:
    """Return (N, H', W', size · size · C): what each place of a filter sees."""
    seen = np.lib.stride_tricks.sliding_window_view(maps, (size, size), axis=(1, 2))
    seen = seen[:, ::STRIDE, ::STRIDE].transpose(0, 1, 2, 4, 5, 3)
    return seen.reshape(*seen.shape[:3], -1)


def _folded(columns: Array, shape: tuple[int, ...], size: int) -> Array:
    """Return the sum of what `_unfolded` has taken from each place: its transpose."""
    maps = np.zeros(shape, np.float32)
    _, high, wide = columns.shape[:3]
    parts = columns.reshape(*columns.shape[:3], size, size, shape[-1])
    for row in range(size):
        for column in range(size):
            rows = slice(row, row + STRIDE * high, STRIDE)
            places = slice(column, column + STRIDE * wide, STRIDE)
            maps[:, rows, places] += parts[:, :, :, row, column]
    return maps


def _softmax(scores: Array) -> Array:
    powers = np.exp(scores - scores.max(axis=1, keepdims=True))
    shares: Array = powers / powers.sum(axis=1, keepdims=True)
    return shares
