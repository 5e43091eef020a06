"""Baselines that classify pixels online: the most frequent class, nearest templates, a convnet.

All are small enough to learn while a stream is drawn, on one core.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.small_convnet import PATCH_PX, SmallConvNet
from sailenv_ros.streams import LabelledPixels, Learner

__all__ = ["LEARNERS", "MostFrequent", "NearestTemplate", "OnlineConvNet", "patches"]

TEMPLATE_PX = 9
MOST_TEMPLATES = 5000
REPLAY = 5000
"""Patches that are kept for replay."""


def patches(
    rgb: NDArray[np.uint8], rows: NDArray[np.int64], columns: NDArray[np.int64], size: int
) -> NDArray[np.float32]:
    """Return (N, size, size, 3) float32: what is around pixels, 0 to 1; edges are repeated.

    Parameters
    ----------
    rgb : (H, W, 3) uint8
    rows, columns : (N,) int64
    size : int
        Odd [px].
    """
    reach = np.arange(size) - size // 2
    height, width = rgb.shape[:2]
    v = (rows[:, None] + reach).clip(0, height - 1)
    u = (columns[:, None] + reach).clip(0, width - 1)
    seen: NDArray[np.float32] = rgb[v[:, :, None], u[:, None, :]].astype(np.float32)
    seen /= np.float32(255.0)
    return seen


class MostFrequent:
    """Always says the class that it has been told most often."""

    def __init__(self, seed: int) -> None:
        self._counts: Counter[int] = Counter()

    def predict(
        self, rgb: NDArray[np.uint8], rows: NDArray[np.int64], columns: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """See `Learner.predict`."""
        known = self._counts.most_common(1)
        return np.full(len(rows), known[0][0] if known else -1, np.int64)

    def learn(self, pixels: LabelledPixels) -> None:
        """See `Learner.learn`."""
        self._counts.update(pixels.categories.tolist())


class NearestTemplate:
    """Template matching: the class of the nearest of the last 5,000 patches of 9 × 9 pixels."""

    def __init__(self, seed: int) -> None:
        self._templates = np.zeros((MOST_TEMPLATES, 3 * TEMPLATE_PX**2), np.float32)
        self._classes = np.zeros(MOST_TEMPLATES, np.int64)
        self._count = 0

    def predict(
        self, rgb: NDArray[np.uint8], rows: NDArray[np.int64], columns: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """See `Learner.predict`."""
        known = min(self._count, MOST_TEMPLATES)
        if not known:
            return np.full(len(rows), -1, np.int64)
        seen = patches(rgb, rows, columns, TEMPLATE_PX).reshape(len(rows), -1)
        templates = self._templates[:known]
        # |a - b|² = |a|² - 2 a·b + |b|²; the first is the same for all templates.
        distances = (templates**2).sum(axis=1) - 2.0 * seen @ templates.T
        nearest: NDArray[np.int64] = self._classes[distances.argmin(axis=1)]
        return nearest

    def learn(self, pixels: LabelledPixels) -> None:
        """See `Learner.learn`."""
        seen = patches(pixels.rgb, pixels.rows, pixels.columns, TEMPLATE_PX)
        places = (self._count + np.arange(len(seen))) % MOST_TEMPLATES
        self._templates[places] = seen.reshape(len(seen), -1)
        self._classes[places] = pixels.categories
        self._count += len(seen)


class OnlineConvNet:
    """A small convnet: one step of Adam on the labels of each frame, with replay or without."""

    def __init__(self, seed: int, *, replay: bool = False) -> None:
        self._net = SmallConvNet(seed)
        self._classes: list[int] = []
        self._places: dict[int, int] = {}
        self._rng = np.random.default_rng(seed)
        self._kept: list[tuple[NDArray[np.float32], int]] = []
        self._replay, self._seen = replay, 0

    def predict(
        self, rgb: NDArray[np.uint8], rows: NDArray[np.int64], columns: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """See `Learner.predict`."""
        if not self._classes:
            return np.full(len(rows), -1, np.int64)
        scores = self._net.scores(patches(rgb, rows, columns, PATCH_PX))
        best = scores[:, : len(self._classes)].argmax(axis=1)
        return np.array([self._classes[place] for place in best.tolist()], np.int64)

    def learn(self, pixels: LabelledPixels) -> None:
        """See `Learner.learn`."""
        seen = patches(pixels.rgb, pixels.rows, pixels.columns, PATCH_PX)
        labels = [self._place(category) for category in pixels.categories.tolist()]
        batch, targets = list(seen), list(labels)
        if self._replay:
            for place in self._rng.integers(0, max(1, len(self._kept)), len(seen)):
                if self._kept:
                    batch.append(self._kept[place][0])
                    targets.append(self._kept[place][1])
            self._keep(seen, labels)
        self._net.step(np.stack(batch), np.array(targets, np.int64))

    def _place(self, category: int) -> int:
        """Return the number of a class; a new one gets the next."""
        place = self._places.setdefault(category, len(self._classes))
        if place == len(self._classes):
            self._classes.append(category)
        return place

    def _keep(self, seen: NDArray[np.float32], labels: list[int]) -> None:
        """Keep each patch with the same chance: J. Vitter's reservoir (ACM TOMS 11, 1985)."""
        for one in zip(seen, labels, strict=True):
            self._seen += 1
            if len(self._kept) < REPLAY:
                self._kept.append(one)
            elif (place := int(self._rng.integers(self._seen))) < REPLAY:
                self._kept[place] = one


def _with_replay(seed: int) -> Learner:
    return OnlineConvNet(seed, replay=True)


LEARNERS: Mapping[str, Callable[[int], Learner]] = MappingProxyType(
    {
        "frequent": MostFrequent,
        "templates": NearestTemplate,
        "convnet": OnlineConvNet,
        "replay": _with_replay,
    }
)
"""Baselines by name: a seed in, a learner out."""
