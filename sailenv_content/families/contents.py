"""Contents of furniture: books in rows, folded clothes, clothes on a rail, plates, jars.

Parts of the piece, each labelled as what it is; they go where their carrier goes.
"""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import fabric, metal, paint
from sailenv_content.families.shaping import cushion, swept, turned

__all__ = ["CLOTHES", "FRUIT", "book_row", "folded", "hung_clothes", "plates", "stores"]

CLOTHES = (
    "#3a4a63",
    "#7a2f2f",
    "#d8d4ca",
    "#2f3b33",
    "#9a8464",
    "#5f5f66",
    "#a85a3a",
    "#42506e",
    "#c8b7a0",
    "#7d8a7a",
    "#26262a",
    "#b4788a",
)
SPINES = (
    "#5b1f1f",
    "#1f3554",
    "#24452f",
    "#6e5a2e",
    "#2a2a2e",
    "#8a3b2a",
    "#c9bda2",
    "#3f2a4a",
    "#7a7f86",
    "#a07c3a",
    "#d9d3c4",
    "#1f4f57",
    "#8c8c3a",
    "#45322a",
)
PAGES = "#e8e0cc"
FRUIT = {
    "apple": ("#b5322a", "#7fa04a", "#c9a13a"),
    "orange": ("#d9762f",),
    "lemon": ("#e0c53a",),
}
"""Colours of each kind, which is its category too."""


def folded(b: PieceBuilder, room: Box) -> None:
    """Lay piles of folded clothes into a hollow."""
    size = room.size
    if size[2] < 0.03 or size[0] < 0.12 or size[1] < 0.12:
        return
    count = max(1, min(5, int(size[1] / 0.24)))
    width = size[1] / count
    with b.part("clothes", "clothes"):
        for number in range(count):
            if b.chance(0.2):
                continue
            y = room.low[1] + (number + 0.5) * width
            z = float(room.low[2])
            while z + 0.03 < room.high[2] - 0.01:
                thick = b.between(0.02, 0.032)
                depth = min(0.30, 0.92 * size[0]) * b.between(0.9, 1.0)
                mesh = cushion(
                    (depth, 0.86 * width * b.between(0.92, 1.0), thick),
                    radius=0.011,
                    puff=0.002,
                    steps=3,
                )
                at = (room.middle[0], y, z + thick / 2.0 + 0.002)
                b.form(fabric(b.pick(*CLOTHES)), mesh, at, collides="none")
                z += thick
                if b.chance(0.3):
                    break


def hung_clothes(b: PieceBuilder, room: Box, *, rail: bool = True) -> None:
    """Hang clothes on a rail below the top of a hollow; without `rail` there is one."""
    size, middle = room.size, room.middle
    z = room.high[2] - 0.06
    if rail:
        bar = [(middle[0], room.low[1], z), (middle[0], room.high[1], z)]
        b.form(metal("chrome"), swept(bar, 0.012, sides=12), collides="none")
    with b.part("clothes", "clothes"):
        y = room.low[1] + 0.05
        while y < room.high[1] - 0.05:
            thick = b.between(0.025, 0.05)
            length = min(b.between(0.55, 1.05), size[2] - 0.16)
            wide = min(b.between(0.38, 0.46), 0.86 * size[0])
            mesh = cushion((wide, thick, length), radius=0.012, puff=0.006, steps=4)
            at = (middle[0], y, z - 0.06 - length / 2.0)
            b.form(
                fabric(b.pick(*CLOTHES)),
                mesh,
                at,
                turn=(0.0, 0.0, b.between(-4.0, 4.0)),
                collides="none",
            )
            hook = [(middle[0], y, z - 0.06), (middle[0], y, z + 0.014)]
            b.form(metal("steel"), swept(hook, 0.002, sides=6), collides="none")
            y += thick + b.between(0.01, 0.06)


def book_row(b: PieceBuilder, room: Box, *, full: float = 1.0, name: str = "books") -> None:
    """Stand books side by side on a hollow's floor; `full` is the share of it that they fill."""
    size = room.size
    y, stop = room.low[1] + 0.004, room.low[1] + full * size[1] - 0.006
    if size[2] < 0.16 or stop - y < 0.05:
        return
    tall = min(b.between(0.20, 0.29), size[2] - 0.015)
    first = y
    with b.part(name, "book"):
        while True:
            thick = b.between(0.014, 0.042)
            if y + thick > stop:
                break
            height = tall * b.between(0.78, 1.0)
            deep = min(b.between(0.13, 0.2), size[0] - 0.02)
            x = room.high[0] - 0.012 - b.between(0.0, 0.015) - deep / 2.0
            z = room.low[2] + height / 2.0
            cover = paint(b.pick(*SPINES), 0.7)
            b.box(
                cover, (deep, thick, height), (x, y + thick / 2.0, z), bevel=0.0015, collides=False
            )
            b.box(
                paint(PAGES, 0.9),
                (deep - 0.006, thick - 0.005, height - 0.0055),
                (x - 0.0035, y + thick / 2.0, z + 0.004),
                bevel=0.0005,
                collides=False,
            )
            if b.chance(0.5):  # a label on the spine
                b.box(
                    paint(b.pick("#d8c48a", "#efe8d8", "#b9a24e"), 0.5),
                    (0.0008, 0.7 * thick, b.between(0.008, 0.03)),
                    (x + deep / 2.0, y + thick / 2.0, z + height * b.between(0.1, 0.3)),
                    bevel=0.0002,
                    collides=False,
                )
            y += thick + 0.0008
        if y > first:
            b.collide(
                (0.16, y - first, tall * 0.9),
                (room.high[0] - 0.1, (first + y) / 2.0, room.low[2] + tall * 0.45),
            )


def plates(b: PieceBuilder, room: Box) -> None:
    """Stand piles of plates and rows of cups on the floor of a hollow."""
    y = room.low[1] + 0.13
    while y < room.high[1] - 0.11:
        glaze = paint(b.pick("#f0ece2", "#dfe5e6", "#c9d3c6", "#39424e"), 0.16, 2300.0)
        x = room.middle[0] - 0.01
        if b.chance(0.5) and room.size[2] > 0.1:
            with b.part("plates", "dish"):
                r = min(b.between(0.09, 0.12), 0.42 * room.size[0])
                for number in range(int(b.rng.integers(3, 8))):
                    z = room.low[2] + 0.001 + 0.007 * number
                    rows = [
                        (0.0, 0.0),
                        (0.55 * r, 0.0),
                        (0.62 * r, 0.004),
                        (r, 0.016),
                        (r, 0.019),
                        (0.6 * r, 0.008),
                        (0.0, 0.006),
                    ]
                    b.form(glaze, turned(rows, segments=24), (x, y, z), collides="none")
        else:
            with b.part("cups", "cup"):
                for number in range(2):
                    r, h = 0.036, min(0.09, room.size[2] - 0.02)
                    rows = [
                        (0.0, 0.0),
                        (0.8 * r, 0.0),
                        (r, 0.02),
                        (r, h),
                        (r - 0.004, h),
                        (r - 0.005, 0.02),
                        (0.0, 0.008),
                    ]
                    at = (x - 0.05 + 0.1 * number, y, room.low[2] + 0.001)
                    b.form(glaze, turned(rows, segments=18), at, collides="none")
        y += 0.27


def stores(b: PieceBuilder, room: Box, *, cold: bool = False) -> None:
    """Stand groceries on the floor of a hollow: jars, bottles, cartons, boxes."""
    y = room.low[1] + 0.06
    while y < room.high[1] - 0.05:
        tall = room.size[2] - 0.02
        kind = b.pick("jar", "bottle", "carton", "box", "none")
        x = room.middle[0] + b.between(-0.06, 0.06)
        at = (x, y, room.low[2] + 0.001)
        if kind == "jar" and tall > 0.1:
            h, r = min(tall, b.between(0.09, 0.15)), 0.037
            with b.part("jar", "jar"):
                rows = [(0.0, 0.0), (r, 0.0), (r, 0.8 * h), (0.75 * r, 0.88 * h), (0.0, 0.88 * h)]
                b.form(
                    paint(b.pick("#a03a22", "#c9933a", "#5d7a3a", "#6b2f45"), 0.2),
                    turned(rows, segments=16),
                    at,
                    collides="none",
                )
                lid = [(0.0, 0.88 * h), (0.8 * r, 0.88 * h), (0.8 * r, h), (0.0, h)]
                b.form(metal("steel"), turned(lid, segments=16), at, collides="none")
        elif kind == "bottle" and tall > 0.22:
            h, r = min(tall, b.between(0.22, 0.31)), 0.036
            with b.part("bottle", "bottle"):
                rows = [
                    (0.0, 0.0),
                    (r, 0.0),
                    (r, 0.6 * h),
                    (0.35 * r, 0.78 * h),
                    (0.35 * r, h),
                    (0.0, h),
                ]
                shade = b.pick("#2f5a34", "#5a3a1e", "#c8d3c4", "#d8d0a0")
                material = paint("#f2f0ea", 0.3) if cold and b.chance(0.4) else paint(shade, 0.1)
                b.form(material, turned(rows, segments=16), at, collides="none")
        elif kind in ("carton", "box") and tall > 0.12:
            h = min(tall, b.between(0.14, 0.24))
            with b.part("carton", "carton"):
                b.box(
                    paint(b.pick("#c9543a", "#e6dccb", "#3a6ea5", "#dcb23a", "#5a8a4a"), 0.6),
                    (0.06, 0.08, h),
                    (x, y, room.low[2] + h / 2.0 + 0.001),
                    collides=False,
                )
        y += b.between(0.09, 0.13)
