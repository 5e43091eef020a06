"""Dishwashers: standing free, of steel, slim, behind a cabinet's front, on a table."""

from __future__ import annotations

from sailenv_content.families.appliances import dishwasher
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import SCHEMES
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values

__all__ = ["FAMILY"]

BLACK = paint("#17181a", 0.3, 700.0)


def _free(b: PieceBuilder, v: Values) -> None:
    """Make one with a lid and a plinth of its own."""
    d, w, h, plinth = v.depth, v.width, v.height, 0.09
    b.box(v.base, (d - 0.08, w - 0.01, plinth), (-0.03, 0.0, plinth / 2))
    outer = Box((-d / 2, -w / 2, plinth), (d / 2, w / 2, h - 0.03))
    dishwasher(b, outer, body=v.body, face=v.face, grip=v.grip, handle_kind=v.handle, strip=v.strip)
    b.box(v.lid, (d, w, 0.03), (0.0, 0.0, h - 0.015), bevel=0.006)


def _integrated(b: PieceBuilder, v: Values) -> None:
    """Make one below a worktop, behind a front like those of the cabinets beside it."""
    d, w, h, plinth, top = v.depth, v.width, v.height, 0.1, 0.035
    b.box(v.scheme[0], (d - 0.1, w, plinth), (-0.05, 0.0, plinth / 2))
    outer = Box((-d / 2, -w / 2, plinth), (d / 2 - 0.02, w / 2, h - top))
    x = d / 2 - 0.048
    panel = Box((x, -w / 2 + 0.002, plinth + 0.002), (d / 2 - 0.02, w / 2 - 0.002, h - top - 0.004))
    dishwasher(
        b,
        outer,
        body=metal("steel", 700.0),
        face=v.scheme[1],
        grip=v.grip,
        kind=v.front,
        handle_kind=v.handle,
        panel=panel,
    )
    b.box(v.top, (d, w, top), (0.0, 0.0, h - top / 2), bevel=0.004)


_WHITE, _STEEL = paint("#eceae5", 0.3, 600.0), metal("steel", 700.0)
_SHARED = {
    "depth": Span(0.58, 0.62),
    "width": 0.6,
    "height": Span(0.83, 0.88),
    "handle": "bar",
    "grip": Choice(_STEEL, metal("chrome"), metal("#26272a")),
}
_FREE = {
    **_SHARED,
    "body": _WHITE,
    "face": _WHITE,
    "lid": _WHITE,
    "base": Choice(paint("#d3d2ce"), BLACK),
    "strip": Choice(_STEEL, BLACK, paint("#d9d9d6")),
    "handle": Choice("bar", "edge"),
}

FAMILY = Family(
    name="dishwasher",
    category="dishwasher",
    least_m=(0.45, 0.4, 0.4),
    most_m=(0.75, 0.7, 1.0),
    styles={
        "free": Style(_free, _FREE),
        "steel": Style(
            _free,
            {
                **_FREE,
                "body": Choice(_STEEL, BLACK),
                "face": Choice(_STEEL, BLACK),
                "lid": Choice(BLACK, *WOODS[:2], _STEEL),
                "base": BLACK,
                "strip": Choice(BLACK, _STEEL),
                "handle": "bar",
            },
        ),
        "slim": Style(
            _free,
            {
                **_FREE,
                "width": 0.45,
                "face": Choice(_WHITE, _STEEL, paint("#b7c4c1"), paint("#33373b")),
                "lid": Choice(_WHITE, *WOODS[:3]),
            },
        ),
        "integrated": Style(
            _integrated,
            {
                **_SHARED,
                "scheme": Choice(*SCHEMES),
                "front": Choice("flat", "shaker", "grooved"),
                "handle": Choice("bar", "knob", "cup"),
                "top": Choice(*WOODS, paint("#3c3f42", 0.25), paint("#dedbd4", 0.25)),
            },
        ),
        "table": Style(
            _free,
            {
                **_FREE,
                "depth": Span(0.48, 0.52),
                "width": 0.55,
                "height": Span(0.45, 0.5),
                "face": Choice(_WHITE, _STEEL, paint("#7c2a2a", 0.3), BLACK),
            },
        ),
    },
)
