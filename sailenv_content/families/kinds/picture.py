"""Pictures: framed paintings with and without a mount, canvases, three in a row, on a desk."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.framing import frame, pictured
from sailenv_content.families.materials import WOODS, PieceMaterial, metal, paint, printed
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.procedural.paintings import ARTS

__all__ = ["FAMILY"]


def _art(b: PieceBuilder, v: Values, aspect: float) -> PieceMaterial:
    """Paint a picture of a width through height."""
    number = int(b.rng.integers(1, 100000))
    return printed(f"canvas {number}", ARTS[v.art](number, aspect))


def _framed(b: PieceBuilder, v: Values) -> None:
    """Hang a picture in a frame, within a mount for some."""
    w, h, bar = v.width, v.width * v.ratio, v.bar
    frame(b, v.material, w, h, bar=bar, depth=v.depth, step=v.step)
    x = 0.5 * v.depth
    inner = (w - 2 * bar + 0.004, h - 2 * bar + 0.004)
    mount = v.mount * min(inner)
    if mount:
        b.box(paint("#efece4", 0.9), (0.003, *inner), (x - 0.003, 0.0, h / 2), collides=False)
    size = (inner[0] - 2 * mount, inner[1] - 2 * mount)
    art = _art(b, v, size[0] / size[1])
    b.form(art, pictured(*size, h / 2, x), collides="none")


def _canvas(b: PieceBuilder, v: Values) -> None:
    """Hang a bare canvas on its stretcher."""
    w, h, deep = v.width * 1.2, v.width * 1.2 * v.ratio, 0.03
    b.box(paint("#e6e1d5", 0.9), (deep, w, h), (deep / 2, 0.0, h / 2), bevel=0.003)
    b.form(_art(b, v, w / h), pictured(w - 0.002, h - 0.002, h / 2, deep + 0.0006), collides="none")


def _three(b: PieceBuilder, v: Values) -> None:
    """Hang narrow frames of one kind side by side."""
    w = v.width * 0.62
    for number in range(v.count):
        y = (number - (v.count - 1) / 2) * (w + v.gap)
        with b.frame((0.0, y, 0.0)):
            _framed(b, Values({**v.all, "width": w}))


def _desk(b: PieceBuilder, v: Values) -> None:
    """Stand a small frame on a strut, leaning back."""
    w, h, d, bar = v.small, v.small * v.ratio, 0.016, 0.3 * v.bar + 0.006
    lean = 12.0
    c, s = np.cos(np.radians(lean)), np.sin(np.radians(lean))

    def at(x: float, y: float, z: float) -> tuple[float, float, float]:
        return (x * c - z * s, y, x * s + z * c + 0.001)

    turn = (0.0, -lean, 0.0)
    for sign in (-1.0, 1.0):
        b.box(v.material, (d, bar, h), at(0, sign * (w - bar) / 2, h / 2), turn=turn, bevel=0.003)
        z = h / 2 + sign * (h - bar) / 2
        b.box(v.material, (d, w - 2 * bar, bar), at(0, 0, z), turn=turn, bevel=0.003)
    b.box(paint("#3a3530", 0.9), (0.005, w - bar, h - bar), at(-0.004, 0, h / 2), turn=turn)
    size = (w - 2 * bar, h - 2 * bar)
    picture = pictured(*size, h / 2, 0.002)
    b.form(_art(b, v, size[0] / size[1]), picture, (0, 0, 0.001), turn=turn, collides="none")
    strut = (0.004, 0.35 * w, 0.62 * h)
    b.box(paint("#3a3530", 0.9), strut, (-0.62 * h * s - 0.03, 0.0, 0.3 * h), turn=(0, 14.0, 0))


_FRAMES = (
    *WOODS,
    metal("brass"),
    metal("#26272a"),
    paint("#e9e6df"),
    paint("#26282b"),
    metal("bronze"),
)
_SHARED = {
    "art": Whole(0, len(ARTS) - 1),
    "width": Span(0.35, 0.8),
    "ratio": Choice(0.7, 0.75, 1.0, 1.3, 1.4),
    "bar": Span(0.018, 0.05),
    "depth": Span(0.02, 0.035),
    "mount": 0.0,
    "step": None,
    "material": Choice(*_FRAMES),
}

FAMILY = Family(
    name="picture",
    category="painting",
    least_m=(0.012, 0.08, 0.08),
    most_m=(0.3, 2.0, 1.5),
    styles={
        "framed": Style(
            _framed, {**_SHARED, "step": Choice(None, metal("brass"), paint("#e9e6df"))}
        ),
        "mounted": Style(
            _framed,
            {
                **_SHARED,
                "mount": Span(0.1, 0.2),
                "bar": Span(0.012, 0.024),
                "width": Span(0.3, 0.6),
            },
        ),
        "canvas": Style(_canvas, _SHARED),
        "row": Style(
            _three,
            {
                **_SHARED,
                "count": Whole(2, 3),
                "gap": Span(0.04, 0.1),
                "bar": Span(0.012, 0.024),
                "mount": Choice(0.0, 0.12),
                "ratio": Choice(1.3, 1.4),
            },
        ),
        "desk": Style(
            _desk,
            {**_SHARED, "small": Span(0.11, 0.18), "ratio": Choice(0.75, 1.0, 1.33)},
            "photo frame",
        ),
    },
)
