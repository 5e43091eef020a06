"""Blinds: rolled, in folds that rise, of slats, of upright vanes, shutters, of bamboo."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import front_panel
from sailenv_content.families.hardware import MAGNET
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import FABRICS, WOODS, PieceMaterial, fabric, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import board, ribbon, swept, turned

__all__ = ["FAMILY"]

WHITE = paint("#e9e7e1", 0.5)


def _cord(b: PieceBuilder, y: float, x: float, h: float, *, loop: bool = False) -> None:
    """Let a cord hang from the head down to the lower end, with a knob on it."""
    for aside in (-0.011, 0.011) if loop else (0.0,):
        path = [(x, y + aside, 0.012), (x, y + aside, h)]
        b.form(WHITE, swept(path, 0.0014, sides=6), collides="none", volume=1e-5)
    knob = turned([(0, 0), (0.007, 0.002), (0.006, 0.02), (0.002, 0.028), (0, 0.028)], segments=12)
    b.form(WHITE, knob, (x, y, 0.0), collides="none")


def _roller(b: PieceBuilder, v: Values) -> None:
    """Roll a cloth on a tube, with a bar in its hem and a loop of beads."""
    w, h, x = v.width, v.height, 0.04
    length = v.down * (h - 0.08)
    tube = swept([(x, -w / 2 + 0.016, h - 0.035), (x, w / 2 - 0.016, h - 0.035)], 0.024, sides=20)
    b.form(v.cloth, tube)
    for sign in (-1.0, 1.0):
        plate = (0.07, 0.006, 0.066)
        b.box(v.metal, plate, (0.036, sign * (w / 2 - 0.008), h - 0.034), bevel=0.002)
    if v.cassette:
        b.box(v.metal, (0.074, w, 0.004), (0.037, 0.0, h), bevel=0.001)
        b.box(v.metal, (0.004, w, 0.075), (0.073, 0.0, h - 0.036), bevel=0.001)
    sheet = x + 0.024
    with b.part("sheet", "blind"):
        size = (0.0016, w - 0.04, length + 0.03)
        b.box(v.cloth, size, (sheet, 0.0, h - 0.035 - size[2] / 2), bevel=0.0004)
        low = h - 0.035 - size[2]
        b.box(v.metal, (0.012, w - 0.036, 0.026), (sheet, 0.0, low), bevel=0.004)
    with b.part("chain", "cable"):
        _cord(b, v.side * (w / 2 - 0.004), x - 0.01, h - 0.03, loop=True)


def _roman(b: PieceBuilder, v: Values) -> None:
    """Hang folds of cloth, which rise one before the other."""
    w, h, count = v.width, v.height, v.folds
    b.box(v.metal, (0.012, w, 0.03), (0.01, 0.0, h - 0.015), bevel=0.003)
    tall = (h - 0.03) / count
    lift = round((1.0 - v.down) * (count - 1) * tall, 3)
    for number in range(count):
        x = 0.012 + 0.009 * (number + 1)
        most = number * tall
        up = max(0.0, lift - (count - 1 - number) * tall)
        low = h - 0.03 - (number + 1) * tall + up
        cloth = v.second if v.striped and number % 2 else v.cloth
        # Each hangs from behind the one above it.
        size = (0.004, w, tall + (0.012 if number else 0.0))
        middle = (x, 0.0, low + size[2] / 2)
        if not number:
            with b.part("fold 1", "blind"):
                b.box(cloth, size, middle, bevel=0.0015)
                b.box(cloth, (0.007, w, 0.022), (x + 0.0005, 0.0, low + 0.011), bevel=0.003)
            continue
        with b.slide(
            f"fold {number + 1}",
            "blind",
            by=most - up,
            back=up,
            axis=(0.0, 0.0, 1.0),
            friction=12.0,
        ):
            b.box(cloth, size, middle, bevel=0.0015)
            b.box(cloth, (0.007, w, 0.022), (x + 0.0005, 0.0, low + 0.011), bevel=0.003)
    _cord(b, v.side * (w / 2 - 0.05), 0.008, h - 0.03)


def _venetian(b: PieceBuilder, v: Values) -> None:
    """Hang slats on ladders of cord, some gathered below, with a rod that turns them."""
    w, h, pitch, deep = v.width, v.height, 0.84 * v.slat, v.slat
    b.box(v.material, (deep + 0.012, w, 0.045), (0.012 + deep / 2, 0.0, h - 0.0225), bevel=0.004)
    if v.valance:
        b.box(v.material, (0.012, w + 0.02, 0.07), (0.026 + deep, 0.0, h - 0.035), bevel=0.004)
    count = int((h - 0.09) / pitch)
    hung = max(4, round(v.down * count))
    x, top = 0.012 + deep / 2, h - 0.06
    turn = (0.0, v.tilt, 0.0)
    curve = np.linspace(-1.0, 1.0, 5)
    thin = 0.0032 if v.wooden else 0.0012
    bow = 0.0 if v.wooden else 0.05 * deep
    profile = np.stack([deep / 2 * curve, bow * (1.0 - curve**2)], axis=-1)
    one = ribbon(profile, w - 0.012, thin, tile_m=v.material.tile_m)
    with b.part("slats", "blind"):
        for number in range(hung):
            z = top - number * pitch
            if v.wooden:
                b.box(
                    v.material, (deep, w - 0.012, thin), (x, 0.0, z), turn=turn, bevel=0.001,
                    collides=False,
                )  # fmt: skip
            else:
                b.form(v.material, one, (x, 0.0, z), turn=turn, collides="none", volume=1e-4)
        low = top - (hung - 0.3) * pitch
        for _ in range(count - hung):
            low -= 1.6 * thin
            flat = (deep, w - 0.012, thin)
            b.box(v.material, flat, (x, 0.0, low), bevel=0.001, collides=False)
        b.box(v.material, (deep, w - 0.01, 0.018), (x, 0.0, low - 0.014), bevel=0.004)
        b.collide((0.4 * deep, w - 0.012, top - low + 0.01), (x, 0.0, (top + low) / 2))
        for place in (-0.38, 0.0, 0.38) if w > 1.2 else (-0.36, 0.36):
            for side in (-1.0, 1.0):
                at = x + side * (deep / 2 + 0.001) * np.cos(np.radians(v.tilt))
                path = [(at, place * w, low - 0.02), (at, place * w, h - 0.045)]
                string = swept(path, 0.0011, sides=5)
                b.form(v.string, string, collides="none", volume=1e-6)
    _cord(b, v.side * (w / 2 - 0.06), x + deep / 2 + 0.006, h - 0.045)
    at = (x + deep / 2 + 0.008, -v.side * (w / 2 - 0.08), h - 0.07)
    with b.hinge("wand", "handle", at=at, axis=(0, 0, 1), opens_deg=180.0, friction=0.02):
        stick = swept([at, (at[0], at[1], at[2] - 0.42 * h)], 0.0045, sides=6)
        b.form(v.material, stick)


def _vanes(b: PieceBuilder, v: Values) -> None:
    """Hang upright vanes from a rail; each turns about its hook."""
    w, h, wide = v.width, v.height, v.vane
    b.box(v.metal, (0.042, w, 0.034), (0.055, 0.0, h - 0.017), bevel=0.004)
    count = round((w - 0.04) / (0.92 * wide))
    pitch = (w - 0.03) / count
    for number in range(count):
        y = (number - (count - 1) / 2) * pitch
        at = (0.055, y, h - 0.04)
        with b.hinge(
            f"vane {number + 1}", "blind", at=at, axis=(0, 0, 1), opens_deg=75.0, friction=0.05
        ):
            turn = (0.0, 0.0, v.turn)
            high = h - 0.055
            cloth = v.cloth if number % 2 or not v.striped else v.second
            tall = high - 0.012
            middle = (0.055, y, high / 2 + 0.006)
            b.box(cloth, (0.0016, wide, tall), middle, turn=turn, bevel=0.0004, collides=False)
            # As a hull: turned boxes that collide cannot be made to fit a window.
            b.hull(board((0.0016, wide, tall), bevel=0.0004), middle, turn=turn)
            b.box(
                WHITE,
                (0.004, wide - 0.004, 0.02),
                (0.055, y, 0.012),
                turn=turn,
                bevel=0.001,
                collides=False,
            )
            hook = turned([(0, 0), (0.005, 0), (0.003, 0.02), (0, 0.02)], segments=8)
            b.form(WHITE, hook, (0.055, y, high - 0.006), collides="none")
    _cord(b, v.side * (w / 2 - 0.02), 0.09, h - 0.03)


def _shutters(b: PieceBuilder, v: Values) -> None:
    """Hinge leaves of slats or boards in a frame on the wall."""
    w, h, bar, deep = v.width, v.height, 0.045, 0.034
    for sign in (-1.0, 1.0):
        b.box(v.material, (deep, bar, h), (deep / 2, sign * (w - bar) / 2, h / 2), bevel=0.004)
        at = (deep / 2, 0.0, h / 2 + sign * (h - bar) / 2)
        b.box(v.material, (deep, w - 2 * bar, bar), at, bevel=0.004)
    opening = Box((deep - 0.026, -w / 2 + bar, bar), (deep + 0.002, w / 2 - bar, h - bar))
    leaves = opening.inset(0.002).columns([1.0] * v.leaves, 0.004)
    names = {2: ("right leaf", "left leaf"), 3: ("right leaf", "leaf", "left leaf")}[v.leaves]
    for name, leaf in zip(names, leaves, strict=True):
        left = name == "left leaf"
        at = (leaf.high[0], leaf.high[1] if left else leaf.low[1], leaf.middle[2])
        axis = (0.0, 0.0, 1.0 if left else -1.0)
        with b.hinge(
            name, "blind", at=at, axis=axis, opens_deg=100.0, friction=0.6, detents=MAGNET
        ):
            half = leaf.middle[2]
            lower = Box(leaf.low, (*leaf.high[:2], half - 0.001))
            upper = Box((*leaf.low[:2], half + 0.001), leaf.high)
            front_panel(b, v.material, v.lower, lower)
            front_panel(b, v.material, "louvre", upper)
            side = leaf.low[1] + 0.02 if left else leaf.high[1] - 0.02
            knob = turned([(0, 0), (0.004, 0), (0.009, 0.014), (0, 0.018)], segments=14)
            b.form(v.metal, knob, (leaf.high[0], side, half), turn=(0, 90, 0), collides="none")


def _bamboo(b: PieceBuilder, v: Values) -> None:
    """Hang sticks of bamboo, rolled up at the lower end."""
    w, h, x, thick = v.width, v.height, 0.03, 0.0042
    b.box(v.reed, (0.022, w, 0.034), (0.012, 0.0, h - 0.017), bevel=0.004)
    low = h - 0.04 - v.down * (h - 0.16)
    pitch = 0.0135
    roll = 0.5 * np.sqrt((1.05 - v.down) * h * 0.0055) + 0.005
    with b.part("mat", "blind"):
        for number in range(int((h - 0.04 - low) / pitch)):
            z = h - 0.04 - number * pitch
            reed = v.reed if (number // 9) % 3 else v.second_reed
            b.box(reed, (thick, w, 0.75 * pitch), (x, 0.0, z), bevel=0.0016, collides=False)
        b.collide((0.008, w, h - 0.04 - low), (x, 0.0, (h - 0.04 + low) / 2))
        path = [(x + roll, -w / 2, low - 0.6 * roll), (x + roll, w / 2, low - 0.6 * roll)]
        b.form(v.reed, swept(path, roll, sides=18, tile_m=0.05))
        spiral = [(x + roll, sign * (w / 2 + 0.0005), low - 0.6 * roll) for sign in (-1.0, 1.0)]
        for at in spiral:
            for share in (0.35, 0.65, 0.95):
                turn = np.linspace(0, 2 * np.pi, 17)
                ring = np.stack(
                    [
                        at[0] + share * roll * np.cos(turn),
                        np.full(17, at[1]),
                        at[2] + share * roll * np.sin(turn),
                    ],
                    axis=-1,
                )
                b.form(v.second_reed, swept(ring, 0.0012, sides=5), collides="none", volume=1e-7)
        for place in (-0.3, 0.3):
            for side in (-1.0, 1.0):
                at_x = x + side * 0.003
                b.form(
                    v.string,
                    swept([(at_x, place * w, low), (at_x, place * w, h - 0.03)], 0.001, sides=5),
                    collides="none",
                    volume=1e-6,
                )
    _cord(b, v.side * (w / 2 - 0.07), 0.012, h - 0.03)


def _reed(colour: str) -> PieceMaterial:
    return paint(colour, 0.6, 450.0)


_CLOTHS = (*FABRICS, *(fabric(c) for c in ("#e4ded0", "#cfd3d1", "#b9b09c", "#a9b0a4")))
_SHARED = {
    "width": Span(1.35, 1.5),
    "height": Span(1.3, 1.45),
    "down": Span(0.2, 0.7),
    "side": Choice(-1.0, 1.0),
    "cloth": Choice(*_CLOTHS),
    "second": Choice(*_CLOTHS),
    "striped": Choice(False, False, True),
    "metal": Choice(metal("alu"), metal("#e6e4de"), metal("#26272a")),
    "string": paint("#d9d4c6", 0.9),
}
_SLATS = (paint("#e9e6df", 0.4), metal("alu"), paint("#3a3d40", 0.4), paint("#b8a58a", 0.4))

FAMILY = Family(
    name="blind",
    category="blind",
    least_m=(0.03, 0.8, 0.9),
    most_m=(0.16, 2.0, 1.8),
    styles={
        "roller": Style(_roller, {**_SHARED, "cassette": Choice(True, False)}),
        "roman": Style(_roman, {**_SHARED, "folds": Whole(4, 6), "down": Span(0.0, 0.6)}),
        "venetian": Style(
            _venetian,
            {
                **_SHARED,
                "wooden": False,
                "material": Choice(*_SLATS),
                "slat": Choice(0.025, 0.035),
                "tilt": Span(-50.0, 50.0),
                "valance": False,
            },
        ),
        "wooden": Style(
            _venetian,
            {
                **_SHARED,
                "wooden": True,
                "material": Choice(*WOODS, paint("#e9e6df")),
                "slat": Span(0.045, 0.055),
                "tilt": Span(-50.0, 50.0),
                "valance": Choice(True, False),
            },
        ),
        "vanes": Style(
            _vanes, {**_SHARED, "vane": Choice(0.089, 0.11), "turn": Choice(90.0, 70.0, 110.0)}
        ),
        "shutters": Style(
            _shutters,
            {
                **_SHARED,
                "material": Choice(*WOODS, paint("#e9e6df"), paint("#8c9a86"), paint("#54616b")),
                "leaves": Choice(2, 3),
                "lower": Choice("louvre", "shaker"),
            },
        ),
        "bamboo": Style(
            _bamboo,
            {
                **_SHARED,
                "reed": Choice(*(_reed(c) for c in ("#b98f5a", "#8c6a42", "#d2b98a"))),
                "second_reed": Choice(*(_reed(c) for c in ("#6b5038", "#9c7a4a", "#c2a878"))),
            },
        ),
    },
)
