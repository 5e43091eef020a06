"""Potted plants: rubber tree, monstera, snake plant, palm, fern, cactus, a small tree."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.crockery import GLAZES
from sailenv_content.families.family import Family, Style
from sailenv_content.families.foliage import (
    BARK,
    DARK,
    DEEP,
    FRESH,
    GREY,
    STEM,
    bush,
    leaf,
    place_leaves,
    planter,
    stem,
    tones,
)
from sailenv_content.families.lathe import smooth_profile
from sailenv_content.families.materials import paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import swept, turned
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]


def _rubber(b: PieceBuilder, v: Values) -> None:
    """Make stems with large leaves in a spiral."""
    soil = planter(b, v.pot, v.radius, v.pot_m, v.shape)
    mesh = leaf(v.leaf, 0.45 * v.leaf, "oval", droop=0.25, fold=0.12, stalk=0.12)
    for number in range(v.stems):
        yaw = 2.1 * number + b.between(0.0, 1.0)
        tall = v.tall * b.between(0.75, 1.0)
        path = stem(b, soil, tall, 0.12 * v.tall * (number > 0), 0.009, yaw)
        count = int(7 + 11 * tall)
        for k in range(count):
            share = 0.18 + 0.82 * k / (count - 1)
            at = path[round(share * 23)]
            place_leaves(
                b,
                b.pick(*v.greens),
                mesh,
                at,
                yaw_deg=137.5 * k + 60 * number,
                rise_deg=15 + 50 * share**2 + b.between(-10, 10),
                roll_deg=b.between(-15, 15),
            )
    bush(b, soil + 0.15 * v.tall, soil + v.tall, v.leaf)


def _monstera(b: PieceBuilder, v: Values) -> None:
    """Make large lobed leaves on long stalks."""
    soil = planter(b, v.pot, v.radius, v.pot_m, v.shape)
    for k in range(v.count):
        yaw = 137.5 * k + b.between(-20, 20)
        c, s = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
        tall, out = v.tall * (0.45 + 0.55 * k / v.count), v.tall * b.between(0.2, 0.42)
        path = curve(
            [
                (0.02 * c, 0.02 * s, soil),
                (0.3 * out * c, 0.3 * out * s, soil + 0.7 * tall),
                (out * c, out * s, soil + tall),
            ],
            9,
        )
        b.form(STEM, swept(path, np.linspace(0.006, 0.0035, 9), sides=7), collides="none")
        size = v.leaf * b.between(0.75, 1.1)
        mesh = leaf(size, 0.85 * size, v.blade, droop=0.35, fold=0.1, wave=0.02)
        place_leaves(
            b,
            b.pick(*v.greens),
            mesh,
            path[-1],
            yaw_deg=yaw,
            rise_deg=b.between(-35, 5),
            roll_deg=b.between(-20, 20),
        )
    bush(b, soil + 0.3 * v.tall, soil + v.tall, 0.42 * v.tall)


def _blades(b: PieceBuilder, v: Values) -> None:
    """Make stiff upright blades, with pale edges for some."""
    soil = planter(b, v.pot, v.radius, v.pot_m, v.shape)
    for k in range(v.count):
        angle = 2.4 * k
        out = 0.6 * v.radius * np.sqrt((k + 0.5) / v.count)
        at = np.array([out * np.cos(angle), out * np.sin(angle), soil - 0.01])
        size = v.tall * b.between(0.55, 1.0)
        yaw, rise, roll = np.degrees(angle), b.between(72, 88), b.between(-60, 60)
        if v.edged:
            rim = leaf(size, 0.062, "strap", droop=0.03, fold=0.12)
            place_leaves(b, v.rim, rim, at, yaw_deg=yaw, rise_deg=rise, roll_deg=roll)
        inner = leaf(0.985 * size, 0.048 if v.edged else 0.058, "strap", droop=0.03, fold=0.1)
        lift = np.array([0.0015 * np.cos(angle + 3.1), 0.0015 * np.sin(angle + 3.1), 0.0])
        place_leaves(
            b, b.pick(*v.greens), inner, at + lift, yaw_deg=yaw, rise_deg=rise, roll_deg=roll
        )
    bush(b, soil, soil + v.tall, 0.8 * v.radius)


def _fronds(b: PieceBuilder, v: Values) -> None:
    """Make arching fronds of narrow leaflets: a palm or a fern."""
    soil = planter(b, v.pot, v.radius, v.pot_m, v.shape)
    base = np.array([0.0, 0.0, soil])
    if v.trunk:
        path = stem(b, soil, v.trunk, 0.03, 0.022, 0.5)
        base = path[-1]
    blades = [
        leaf(v.leaf * s, v.narrow * v.leaf, v.blade, droop=0.25, fold=0.2) for s in (0.5, 0.8, 1.0)
    ]
    for k in range(v.count):
        yaw = np.radians(137.5 * k + b.between(-15, 15))
        c, s = np.cos(yaw), np.sin(yaw)
        rise, reach = v.tall * b.between(0.55, 1.0), v.reach * b.between(0.7, 1.0)
        path = (
            curve(
                [
                    (0, 0, 0),
                    (0.25 * reach * c, 0.25 * reach * s, 0.7 * rise),
                    (0.65 * reach * c, 0.65 * reach * s, rise),
                    (reach * c, reach * s, v.hang * rise),
                ],
                26,
            )
            + base
        )
        b.form(STEM, swept(path, np.linspace(0.0035, 0.001, 26), sides=5), collides="none")
        green = b.pick(*v.greens)
        rows = np.arange(v.bare, 26, v.skip)
        ahead = path[np.minimum(rows + 1, 25)] - path[rows - 1]
        heading = np.degrees(np.arctan2(ahead[:, 1], ahead[:, 0]))
        pitch = np.degrees(np.arctan2(ahead[:, 2], np.hypot(ahead[:, 0], ahead[:, 1])))
        share = np.sin(np.pi * np.minimum(0.97, (rows - v.bare + 2) / (27 - v.bare)))
        size = np.where(share < 0.4, 0, np.where(share < 0.75, 1, 2))
        for number, mesh in enumerate(blades):
            mine = size == number
            for sign in (-1.0, 1.0):
                place_leaves(
                    b,
                    green,
                    mesh,
                    path[rows[mine]],
                    yaw_deg=heading[mine] + sign * 58,
                    rise_deg=0.5 * pitch[mine] + 8,
                    roll_deg=sign * 12,
                )
    top = float(base[2])
    bush(b, top, top + v.tall, 0.6 * v.reach)


def _cactus(b: PieceBuilder, v: Values) -> None:
    """Make ribbed columns, or a ball, with pale spines."""
    soil = planter(b, v.pot, v.radius, v.pot_m, v.shape)
    green = b.pick(*v.greens)
    columns = [(0.0, 0.0, v.tall, 0.42 * v.radius)]
    for k in range(0 if v.ball else v.arms):
        angle = 2.3 * k + 0.7
        columns.append(
            (
                0.55 * v.radius * np.cos(angle),
                0.55 * v.radius * np.sin(angle),
                v.tall * b.between(0.35, 0.7),
                0.28 * v.radius,
            )
        )
    for x, y, tall, r in columns:
        if v.ball:
            r = 1.6 * r
            tall = min(tall, 2.0 * r)
        profile = ((0.85, 0.0), (1.0, 0.3), (0.95, 0.75), (0.6, 0.95), (0.0, 1.0))
        rows = smooth_profile(np.array(profile) * (r, tall), 14)
        mesh = turned([(0, 0), *rows], segments=2 * v.ribs)
        ridge = np.where(np.arange(2 * v.ribs) % 2, 1.0, 0.82)
        angles = np.arctan2(mesh.positions[:, 1], mesh.positions[:, 0])
        slot = np.rint(angles / (np.pi / v.ribs)).astype(int) % (2 * v.ribs)
        positions = mesh.positions.copy()
        positions[:, :2] *= ridge[slot][:, None]
        ribbed = type(mesh)(
            positions=positions, normals=mesh.normals, uvs=mesh.uvs, triangles=mesh.triangles
        )
        b.form(green, ribbed, (x, y, soil - 0.012))
        spine = turned([(0, 0), (0.0007, 0.001), (0, 0.011)], segments=5)
        for rib in range(v.ribs):
            angle = (2 * rib + 1) * np.pi / v.ribs
            for row in rows[2:-1:2]:
                at = (x + row[0] * np.cos(angle), y + row[0] * np.sin(angle), soil - 0.012 + row[1])
                turn = (0.0, 80.0, np.degrees(angle))
                b.form(v.spines, spine, at, turn=turn, collides="none", volume=1e-9)


def _tree(b: PieceBuilder, v: Values) -> None:
    """Make a trunk with branches and many small leaves."""
    soil = planter(b, v.pot, v.radius, v.pot_m, v.shape)
    trunk = stem(b, soil, 0.6 * v.tall, 0.1 * v.tall, 0.035 * v.tall, b.between(0, 6))
    top = trunk[-1]
    mesh = leaf(v.leaf, v.narrow * v.leaf, "leaflet", droop=0.2, fold=0.15)
    crown = 0.34 * v.tall
    for k in range(v.count):
        yaw, lift = 2.4 * k, b.between(0.1, 1.0)
        out = crown * b.between(0.6, 1.0)
        end = top + np.array([out * np.cos(yaw), out * np.sin(yaw), crown * (lift - 0.25) * 1.2])
        start = trunk[round(23 * b.between(0.75, 1.0))]
        mid = (start + end) / 2 + np.array([0, 0, 0.12 * crown])
        path = curve([start, mid, end], 9)
        b.form(
            BARK,
            swept(path, np.linspace(0.012 * v.tall, 0.004 * v.tall, 9), sides=5),
            collides="none",
        )
        places = np.repeat(path[2:], v.dense, axis=0)
        places = places + b.rng.normal(0.0, 0.14 * crown, places.shape)
        count = len(places)
        for green, mine in zip(
            v.greens, np.array_split(b.rng.permutation(count), len(v.greens)), strict=True
        ):
            place_leaves(
                b,
                green,
                mesh,
                places[mine],
                yaw_deg=b.rng.uniform(0, 360, len(mine)),
                rise_deg=b.rng.uniform(-40, 50, len(mine)),
                roll_deg=b.rng.uniform(-40, 40, len(mine)),
            )
    bush(b, float(top[2]) - 0.4 * crown, float(top[2]) + 1.1 * crown, crown)


_POTS = (
    *GLAZES,
    paint("#b5694a", 0.85, 1900.0),
    paint("#8d8a84", 0.85, 1900.0),
    paint("#b98f74", 0.85, 1900.0),
)
_SHARED = {
    "pot": Choice(*_POTS),
    "radius": Span(0.12, 0.17),
    "pot_m": Span(0.22, 0.32),
    "shape": Choice("cone", "cylinder", "round", "rim"),
    "greens": Choice(DEEP, FRESH),
}
_SMALL = {**_SHARED, "radius": Span(0.06, 0.09), "pot_m": Span(0.1, 0.14)}

FAMILY = Family(
    name="plant",
    category="potted plant",
    least_m=(0.1, 0.1, 0.14),
    most_m=(1.9, 1.9, 2.3),
    styles={
        "rubber": Style(
            _rubber,
            {
                **_SHARED,
                "stems": Whole(1, 3),
                "tall": Span(0.6, 1.2),
                "leaf": Span(0.2, 0.28),
                "greens": Choice(DEEP, DARK),
            },
        ),
        "monstera": Style(
            _monstera,
            {
                **_SHARED,
                "count": Whole(9, 15),
                "tall": Span(0.5, 0.9),
                "leaf": Span(0.24, 0.34),
                "blade": Choice("lobed", "lobed", "heart"),
            },
        ),
        "snake": Style(
            _blades,
            {
                **_SHARED,
                "radius": Span(0.08, 0.13),
                "pot_m": Span(0.13, 0.2),
                "count": Whole(9, 16),
                "tall": Span(0.4, 0.8),
                "edged": Choice(True, False),
                "rim": Choice(*tones("#b9b46a", "#c9c98a")),
                "greens": Choice(DEEP, GREY),
            },
        ),
        "palm": Style(
            _fronds,
            {
                **_SHARED,
                "trunk": Choice(0.0, 0.25, 0.5),
                "count": Whole(9, 14),
                "tall": Span(0.5, 0.8),
                "reach": Span(0.4, 0.65),
                "leaf": Span(0.2, 0.3),
                "narrow": 0.11,
                "blade": "lance",
                "hang": Span(0.55, 0.9),
                "bare": 8,
                "skip": 2,
            },
        ),
        "fern": Style(
            _fronds,
            {
                **_SMALL,
                "trunk": 0.0,
                "count": Whole(16, 24),
                "tall": Span(0.16, 0.26),
                "reach": Span(0.24, 0.36),
                "leaf": Span(0.045, 0.06),
                "narrow": 0.3,
                "blade": "leaflet",
                "hang": Span(-0.4, 0.3),
                "bare": 3,
                "skip": 1,
                "greens": FRESH,
            },
        ),
        "cactus": Style(
            _cactus,
            {
                **_SMALL,
                "tall": Span(0.12, 0.3),
                "arms": Whole(0, 3),
                "ribs": Whole(8, 12),
                "ball": Choice(True, False),
                "spines": Choice(*tones("#e6dcc0", "#c9a45c")),
                "greens": Choice(DEEP, GREY, FRESH),
            },
        ),
        "tree": Style(
            _tree,
            {
                **_SHARED,
                "tall": Span(0.5, 1.4),
                "count": Whole(9, 13),
                "leaf": Span(0.055, 0.085),
                "narrow": Choice(0.35, 0.6),
                "dense": Whole(8, 11),
                "greens": Choice(GREY, FRESH, DEEP),
            },
        ),
    },
)
