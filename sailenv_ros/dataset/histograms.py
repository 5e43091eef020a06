"""Counts between edges → a drawing of bars, as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

__all__ = ["histogram_svg"]

_BAR, _HEIGHT, _LEFT, _TOP, _BELOW = 48, 160, 8, 34, 26


def histogram_svg(counts: Sequence[int], edges: Sequence[float], title: str) -> str:
    """Return a histogram.

    Parameters
    ----------
    counts : sequence of int
        Of each bin.
    edges : sequence of float
        One more than there are bins.
    title : str
    """
    most = max(1, *counts)
    width = 2 * _LEFT + _BAR * len(counts)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" '
        f'height="{_TOP + _HEIGHT + _BELOW}" font-family="sans-serif" font-size="11">',
        '<rect width="100%" height="100%" fill="white"/>',
        f'<text x="{_LEFT}" y="14" font-size="13">{escape(title)}</text>',
    ]
    for index, count in enumerate(counts):
        left, high = _LEFT + index * _BAR, _HEIGHT * count / most
        top = _TOP + _HEIGHT - high
        parts.append(
            f'<rect x="{left + 2}" y="{top:.1f}" width="{_BAR - 4}" height="{high:.1f}" '
            'fill="#4878a8"/>'
        )
        if count:
            parts.append(
                f'<text x="{left + _BAR / 2:g}" y="{top - 3:.1f}" text-anchor="middle">'
                f"{count}</text>"
            )
    for index, edge in enumerate(edges):
        parts.append(
            f'<text x="{_LEFT + index * _BAR}" y="{_TOP + _HEIGHT + 15}" '
            f'text-anchor="middle">{edge:.4g}</text>'
        )
    return "\n".join([*parts, "</svg>", ""])
