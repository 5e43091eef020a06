"""Mirrors: framed, round, with an arch, standing, with a cabinet behind it."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import BOARD_M, unit
from sailenv_content.families.contents import stores
from sailenv_content.families.family import Family, Style
from sailenv_content.families.framing import frame
from sailenv_content.families.fronts import handle
from sailenv_content.families.hardware import MAGNET
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import shelf
from sailenv_content.families.lathe import closed_ring, scaled
from sailenv_content.families.materials import WOODS, PieceMaterial, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import extruded, placed
from sailenv_content.procedural.forms import circle
from sailenv_ros.types.model import Material

__all__ = ["FAMILY"]

SILVER = PieceMaterial(
    Material(name="silvering", base_colour=(0.9, 0.92, 0.92, 1.0), metallic=1.0, roughness=0.02),
    1.0,
    2500.0,
)

# What is drawn as a flat mirror is flat to a millimetre, and what is nearer to its plane than 4 mm
# counts as it: edges are ground less, frames stand back or out by more.
EDGE_M, PROUD_M = 0.0006, 0.0055


def _framed(b: PieceBuilder, v: Values) -> None:
    """Hang a mirror in a frame."""
    w, h, bar = v.width, v.width * v.ratio, v.bar
    frame(b, v.material, w, h, bar=bar, depth=v.depth, step=v.step)
    size = (0.004, w - 2 * bar + 0.004, h - 2 * bar + 0.004)
    b.box(SILVER, size, (0.42 * v.depth, 0.0, h / 2), bevel=EDGE_M, collides=False)


def _upright(
    b: PieceBuilder, material: PieceMaterial, outline: np.ndarray, thick: float, x: float, z: float
) -> None:
    """Stand an outline in y and z on the wall."""
    bevel = EDGE_M if material is SILVER else 0.0015
    mesh = placed(
        extruded(outline, thick, bevel=bevel, tile_m=material.tile_m), (0, 0, 0), (90, 0, 90)
    )
    b.form(material, mesh, (x, 0.0, z))


def _round(b: PieceBuilder, v: Values) -> None:
    """Hang a round or oval mirror, with a thin or a wide rim."""
    r, oval = v.width / 2, v.oval
    h = 2 * r * oval
    disc = circle(56) * (r - 0.4 * v.bar, (r - 0.4 * v.bar) * oval)
    _upright(b, SILVER, disc, 0.005, 0.006, h / 2)
    rows = [
        (r - v.bar, 0.0),
        (r, 0.0),
        (r, 0.7 * v.depth),
        (r - 0.4 * v.bar, v.depth),
        (r - v.bar, 0.8 * v.depth),
    ]
    ring = scaled(closed_ring(rows, segments=56), (oval, 1.0, 1.0))
    b.form(v.material, placed(ring, (0, 0, 0), (0, 90, 0)), (0.0, 0.0, h / 2), collides="none")


def _arch(b: PieceBuilder, v: Values) -> None:
    """Hang or lean a tall mirror with a round top."""
    w, h = v.width, v.tall

    def outline(rim: float) -> np.ndarray:
        r = w / 2 - rim
        turn = np.linspace(0.0, np.pi, 25)
        top = np.stack([r * np.cos(turn), h - w / 2 + r * np.sin(turn)], -1)
        return np.concatenate([[(-r, rim), (r, rim)], top])

    _upright(b, v.material, outline(0.0) - np.array([0.0, h / 2]), v.depth, 0.0, h / 2)
    pane = outline(v.bar) - np.array([0.0, h / 2])
    _upright(b, SILVER, pane, PROUD_M + 0.001, v.depth - 0.001, h / 2)
    if v.panes:
        x, thick = v.depth + PROUD_M, 2.0 * PROUD_M
        b.box(v.material, (thick, 0.012, h - v.bar), (x, 0.0, h / 2), collides=False)
        for z in np.linspace(0.0, h - w / 2, 4)[1:]:
            b.box(v.material, (thick, w - v.bar, 0.012), (x, 0.0, float(z)), collides=False)


def _standing(b: PieceBuilder, v: Values) -> None:
    """Hang a tall mirror between two posts, so that it turns."""
    w, post = v.width, 0.9 * v.tall
    for sy in (-1.0, 1.0):
        y = sy * (w / 2 + 0.03)
        b.box(v.material, (0.03, 0.03, post), (0.0, y, post / 2 + 0.03), bevel=0.005)
        b.box(v.material, (0.42, 0.036, 0.035), (0.0, y, 0.0175), bevel=0.008)
    b.box(v.material, (0.03, w + 0.03, 0.03), (0.0, 0.0, 0.09))
    middle, low = 0.62 * post, 0.14
    tall = 2 * (middle - low)
    with b.hinge(
        "mirror", "mirror", at=(0, 0, middle), axis=(0, -1, 0), opens_deg=18.0, friction=1.0
    ):
        b.box(v.material, (0.022, w, tall), (0.0, 0.0, middle), bevel=0.004)
        size = (PROUD_M + 0.001, w - 2 * v.bar, tall - 2 * v.bar)
        at = (0.01 + size[0] / 2, 0.0, middle)
        b.box(SILVER, size, at, bevel=EDGE_M, collides=False)


def _cabinet(b: PieceBuilder, v: Values) -> None:
    """Hang a shallow cabinet with bottles behind doors of mirror."""
    d, w, h = 0.15, v.width * 1.1, v.width * 1.05
    outer = Box((0.0, -w / 2, 0.0), (d, w / 2, h))
    inside, fronts = unit(b, v.body, outer)
    for row in inside.rows([1.0] * 3, BOARD_M):
        if row.low[2] > inside.low[2] + 0.01:
            shelf(b, v.body, inside, float(row.low[2]), thick=0.01)
        stores(b, row.within((0.0, 0.02, 0.0), (0.03, 0.02, 0.02)))
    shares = [1.0] * v.doors
    for number, leaf in enumerate(fronts.columns(shares, 0.003)):
        side = "right" if number == 0 and v.doors > 1 else "left"
        name = f"{side} door" if v.doors > 1 else "door"
        left = side == "left"
        at = (
            float(leaf.high[0]),
            float(leaf.high[1] if left else leaf.low[1]),
            float(leaf.middle[2]),
        )
        axis = (0.0, 0.0, 1.0 if left else -1.0)
        with b.hinge(name, "mirror", at=at, axis=axis, opens_deg=105.0, detents=MAGNET):
            size = leaf.size
            b.box(
                v.body, (size[0] - 0.006, size[1], size[2]), leaf.middle - np.array([0.003, 0, 0])
            )
            b.box(
                SILVER,
                (0.004, size[1], size[2]),
                (leaf.high[0] - 0.002, *leaf.middle[1:]),
                bevel=EDGE_M,
            )
            grip = float(leaf.low[1]) + 0.02 if left else float(leaf.high[1]) - 0.02
            handle(b, v.metal, "knob", float(leaf.high[0]), grip, 0.15 * h)


_FRAMES = (*WOODS, metal("brass"), metal("#26272a"), paint("#e9e6df"), metal("bronze"))
_SHARED = {
    "width": Span(0.4, 0.75),
    "ratio": Choice(1.0, 1.3, 1.5, 0.7),
    "tall": Span(1.3, 1.7),
    "bar": Span(0.02, 0.05),
    "depth": Span(0.02, 0.035),
    "step": Choice(None, metal("brass"), paint("#e9e6df")),
    "material": Choice(*_FRAMES),
}

FAMILY = Family(
    name="mirror",
    category="mirror",
    least_m=(0.012, 0.3, 0.25),
    most_m=(0.6, 1.0, 1.9),
    styles={
        "framed": Style(_framed, _SHARED),
        "round": Style(
            _round, {**_SHARED, "oval": Choice(1.0, 1.0, 1.35), "bar": Span(0.01, 0.05)}
        ),
        "arch": Style(_arch, {**_SHARED, "panes": Choice(True, False), "bar": Span(0.015, 0.03)}),
        "standing": Style(
            _standing,
            {**_SHARED, "width": Span(0.42, 0.55), "material": Choice(*WOODS, metal("#26272a"))},
        ),
        "cabinet": Style(
            _cabinet,
            {
                **_SHARED,
                "width": Span(0.5, 0.75),
                "doors": Choice(1, 2),
                "body": Choice(paint("#e9e6df"), *WOODS[:3]),
                "metal": Choice(metal("chrome"), metal("brass"), metal("#26272a")),
            },
        ),
    },
)
