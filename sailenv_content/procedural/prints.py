"""Printed surfaces: labels of jars and cartons, covers, dials, photographs."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_content.procedural.shapes import Vector3
from sailenv_ros.types.model import Texture

__all__ = ["Sheet"]

_FINE = 4
"""Number of samples along each axis over which a drawing is averaged."""


class Sheet:
    """A sheet to print on; places are shares of its width and height, from its upper left corner.

    Parameters
    ----------
    width, height : int
        [px].
    colour : (3,) tuple of float
        Of the paper, sRGB from 0 to 1, as all colours here.
    """

    def __init__(self, width: int, height: int, colour: Vector3) -> None:
        self._size = np.array([width, height])
        self._pixels: NDArray[np.uint8] = np.empty((height * _FINE, width * _FINE, 3), np.uint8)
        self._pixels[:] = _bytes(colour)

    def box(self, left: float, top: float, right: float, bottom: float, colour: Vector3) -> Sheet:
        """Fill a rectangle."""
        cv2.rectangle(
            self._pixels, self._at(left, top), self._at(right, bottom), _bytes(colour), cv2.FILLED
        )
        return self

    def disc(self, x: float, y: float, radius: float, colour: Vector3) -> Sheet:
        """Fill a circle; its radius is a share of the sheet's height."""
        size = max(1, round(radius * float(self._size[1]) * _FINE))
        cv2.circle(self._pixels, self._at(x, y), size, _bytes(colour), cv2.FILLED, cv2.LINE_AA)
        return self

    def area(self, points: Sequence[tuple[float, float]], colour: Vector3) -> Sheet:
        """Fill a polygon."""
        corners = np.array([self._at(x, y) for x, y in points], np.int32)
        cv2.fillPoly(self._pixels, [corners], _bytes(colour), cv2.LINE_AA)
        return self

    def line(
        self, start: tuple[float, float], end: tuple[float, float], width: float, colour: Vector3
    ) -> Sheet:
        """Draw a line; its width is a share of the sheet's height."""
        thick = max(1, round(width * float(self._size[1]) * _FINE))
        cv2.line(self._pixels, self._at(*start), self._at(*end), _bytes(colour), thick, cv2.LINE_AA)
        return self

    def text(self, words: str, x: float, y: float, height: float, colour: Vector3) -> Sheet:
        """Write words about a middle; their height is a share of the sheet's."""
        pixels = height * float(self._size[1]) * _FINE
        scale, thick = pixels / 22.0, max(1, round(pixels / 7.0))
        (width, tall), _ = cv2.getTextSize(words, cv2.FONT_HERSHEY_DUPLEX, scale, thick)
        left, middle = self._at(x, y)
        place = (left - width // 2, middle + tall // 2)
        cv2.putText(
            self._pixels,
            words,
            place,
            cv2.FONT_HERSHEY_DUPLEX,
            scale,
            _bytes(colour),
            thick,
            cv2.LINE_AA,
        )
        return self

    def lines(
        self, left: float, top: float, right: float, count: int, step: float, colour: Vector3
    ) -> Sheet:
        """Draw rows of small print as grey strokes of uneven lengths."""
        generator = np.random.default_rng(count)
        for row in range(count):
            end = right - (right - left) * float(generator.uniform(0.0, 0.25))
            y = top + row * step
            self.line((left, y), (end, y), 0.35 * step, colour)
        return self

    def shade(self, top: Vector3, bottom: Vector3) -> Sheet:
        """Fill the whole sheet from one colour to another."""
        share = np.linspace(0.0, 1.0, len(self._pixels))[:, None, None]
        colours = (1.0 - share) * np.array(_bytes(top)) + share * np.array(_bytes(bottom))
        self._pixels[:] = np.rint(colours)
        return self

    def texture(self) -> Texture:
        """Return what is printed."""
        width, height = (int(side) for side in self._size)
        small = cv2.resize(self._pixels, (width, height), interpolation=cv2.INTER_AREA)
        pixels = np.full((height, width, 4), 255, np.uint8)
        pixels[..., :3] = small
        pixels.flags.writeable = False
        return pixels

    def _at(self, x: float, y: float) -> tuple[int, int]:
        column, row = np.rint(np.array([x, y]) * self._size * _FINE).astype(int)
        return int(column), int(row)


def _bytes(colour: Vector3) -> tuple[int, int, int]:
    red, green, blue = (int(np.clip(round(255.0 * value), 0, 255)) for value in colour)
    return red, green, blue
