"""A focus of attention that falls towards details and motion, as a body falls to masses.

Source: Zanca, Melacci and Gori, "Gravitational laws of focus of attention", 2019, in its simplest
form: masses are the gradient of brightness and what moves, weighed; a drag takes energy. What has
been looked at loses its mass and gets it back.
"""

from __future__ import annotations

from typing import Any

import cv2 as typed_cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["GravitationalFocus"]

cv2: Any = typed_cv2  # OpenCV's annotations lack functions of its own

STEPS = 10
"""Steps of integration between two pictures."""

DRAG = 0.05
DETAIL, MOTION = 0.1, 1.0
"""Weights of the masses, those of the published streams in colour."""

PULL = 40.0
LEAST_WAY_PX = 4.0
RECOVERY = 0.9
"""Share of what is tired that is still tired a picture later."""

REACH_PX = 12.0


class GravitationalFocus:
    """Follows pictures.

    Parameters
    ----------
    height, width : int
        Of the pictures [px].
    """

    def __init__(self, height: int, width: int) -> None:
        self._rows, self._columns = np.mgrid[:height, :width].astype(np.float32)
        self._place = np.array([(height - 1) / 2.0, (width - 1) / 2.0])
        self._speed = np.zeros(2)
        self._tired = np.zeros((height, width), np.float32)

    def follow(self, picture: NDArray[np.uint8], moves: NDArray[np.bool_]) -> tuple[int, int]:
        """Move on by a picture; return row and column of the focus."""
        grey = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY).astype(np.float32) / 255.0
        detail = np.hypot(cv2.Sobel(grey, -1, 1, 0), cv2.Sobel(grey, -1, 0, 1))
        mass = DETAIL * _share(detail) + MOTION * _share(moves.astype(np.float32))
        mass = mass * (1.0 - self._tired)
        for _ in range(STEPS):
            down, right = self._rows - self._place[0], self._columns - self._place[1]
            near = mass / np.maximum(down * down + right * right, LEAST_WAY_PX**2)
            pull = PULL * np.array([(near * down).sum(), (near * right).sum()])
            self._speed = (1.0 - DRAG) * self._speed + pull / STEPS
            self._place = self._place + self._speed / STEPS
            limit = np.array(grey.shape) - 1.0
            self._speed = np.where(
                (self._place < 0.0) | (self._place > limit), -self._speed, self._speed
            )
            self._place = np.clip(self._place, 0.0, limit)
        down, right = self._rows - self._place[0], self._columns - self._place[1]
        seen = np.exp(-(down * down + right * right) / (2.0 * REACH_PX**2))
        self._tired = np.maximum(RECOVERY * self._tired, 0.5 * seen).astype(np.float32)
        return round(float(self._place[0])), round(float(self._place[1]))


def _share(values: NDArray[np.float32]) -> NDArray[np.float32]:
    total = float(values.sum())
    return values / total if total else values
