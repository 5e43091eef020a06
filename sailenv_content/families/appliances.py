"""Kitchen appliances: ovens, dishwashers and hobs, alone or built in; the front is at +x."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.fronts import FrontKind, flap
from sailenv_content.families.hardware import KNOB_CLICKS, SEAL
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import PieceMaterial, glass, metal, paint
from sailenv_content.families.shaping import turned

__all__ = ["dishwasher", "gas_hob", "glass_hob", "hollow_case", "knob_row", "oven", "wire_basket"]

BLACK = paint("#17181a", 0.3, 1200.0)
ENAMEL = paint("#3a3d42", 0.35, 900.0)
STEEL = metal("steel", 1500.0)


def hollow_case(
    b: PieceBuilder, material: PieceMaterial, outer: Box, wall: float, *, liner: PieceMaterial
) -> Box:
    """Add walls around a hollow that is open at its front, lined inside; return the hollow."""
    room = outer.within((wall, wall, wall), (0.0, wall, wall))
    size, middle = outer.size, outer.middle
    for sign in (-1.0, 1.0):
        at = (middle[0], middle[1] + sign * (size[1] - wall) / 2, middle[2])
        b.box(material, (size[0], wall, size[2]), at, bevel=0.004)
        at = (middle[0], middle[1], middle[2] + sign * (size[2] - wall) / 2)
        b.box(material, (size[0], size[1] - 2 * wall, wall), at, bevel=0.002)
    at = (outer.low[0] + wall / 2, middle[1], middle[2])
    b.box(material, (wall, size[1] - 2 * wall, size[2] - 2 * wall), at, bevel=0.001)
    skin = 0.002
    inner, mid = room.size, room.middle
    for sign in (-1.0, 1.0):
        side = (mid[0], mid[1] + sign * (inner[1] - skin) / 2, mid[2])
        b.box(liner, (inner[0] - 0.002, skin, inner[2]), side, bevel=0.0003, collides=False)
        level = (mid[0], mid[1], mid[2] + sign * (inner[2] - skin) / 2)
        b.box(liner, (inner[0] - 0.002, inner[1], skin), level, bevel=0.0003, collides=False)
    back = (room.low[0] + skin / 2, mid[1], mid[2])
    b.box(liner, (skin, inner[1], inner[2]), back, bevel=0.0003, collides=False)
    return room


def wire_basket(
    b: PieceBuilder, material: PieceMaterial, room: Box, *, pitch: float = 0.035, rod: float = 0.004
) -> None:
    """Add a grid of rods over a hollow's floor, and a rim at its upper side if it has a height."""
    size, middle = room.size, room.middle
    z = room.low[2] + rod / 2
    count = max(4, round(float(size[1]) / pitch))
    for number in range(count + 1):
        y = room.low[1] + rod / 2 + (size[1] - rod) * number / count
        b.box(material, (size[0], rod, rod), (middle[0], y, z), bevel=0.001, collides=False)
    for number in range(3):
        x = room.low[0] + rod / 2 + (size[0] - rod) * number / 2
        b.box(material, (rod, size[1], rod), (x, middle[1], z), bevel=0.001, collides=False)
    b.collide((size[0], size[1], rod), (middle[0], middle[1], z))
    if size[2] < 0.04:
        return
    for level in (0.5, 1.0):
        high = room.low[2] + level * (size[2] - rod) + rod / 2
        for sign in (-1.0, 1.0):
            at = (middle[0] + sign * (size[0] - rod) / 2, middle[1], high)
            b.box(material, (rod, size[1], rod), at, bevel=0.001, collides=False)
            at = (middle[0], middle[1] + sign * (size[1] - rod) / 2, high)
            b.box(material, (size[0], rod, rod), at, bevel=0.001, collides=False)
    for number in range(9):
        for sign in (-1.0, 1.0):
            x = room.low[0] + rod / 2 + (size[0] - rod) * number / 8
            at = (x, middle[1] + sign * (size[1] - rod) / 2, middle[2])
            b.box(material, (rod, rod, size[2]), at, bevel=0.001, collides=False)
            y = room.low[1] + rod / 2 + (size[1] - rod) * number / 8
            at = (middle[0] + sign * (size[0] - rod) / 2, y, middle[2])
            b.box(material, (rod, rod, size[2]), at, bevel=0.001, collides=False)


def knob_row(
    b: PieceBuilder,
    material: PieceMaterial,
    x: float,
    z: float,
    places: list[float],
    *,
    radius: float = 0.02,
) -> None:
    """Add knobs that turn and click, on a face at x, at places along y."""
    profile = [(0, 0), (radius, 0), (radius * 0.95, 0.016), (radius * 0.82, 0.02), (0, 0.02)]
    for number, y in enumerate(places):
        name, at = f"knob {number + 1}", (x + 0.0025, y, z)
        with b.hinge(
            name,
            "handle",
            at=at,
            axis=(-1.0, 0.0, 0.0),
            opens_deg=270.0,
            friction=0.05,
            damping=0.02,
            detents=KNOB_CLICKS,
        ):
            b.form(material, turned(profile, segments=20), at, turn=(0.0, 90.0, 0.0))
            mark = (x + 0.023, y, z + 0.55 * radius)
            pale = paint("#e8e6e0") if material is BLACK else BLACK
            b.box(pale, (0.002, 0.0025, 0.8 * radius), mark, bevel=0.0005, collides=False)


def oven(
    b: PieceBuilder,
    outer: Box,
    *,
    body: PieceMaterial,
    face: PieceMaterial,
    knobs: PieceMaterial,
    grip: PieceMaterial,
    prefix: str = "",
    control_m: float = 0.1,
    count: int = 4,
) -> None:
    """Add an oven: a case, a glazed door that folds down, a rack and a tray on slides, knobs.

    Parameters
    ----------
    control_m : float
        Height of the panel with its knobs and clock [m]; 0 for none.
    count : int
        Of knobs.
    """
    thick = 0.034
    face_x, width = float(outer.high[0]), float(outer.size[1])
    case = outer.within(high=(thick, 0.0, control_m))
    room = hollow_case(b, body, case, 0.03, liner=ENAMEL)
    if control_m:
        control = Box((outer.low[0], outer.low[1], case.high[2]), outer.high)
        b.box(face, control.size, control.middle, bevel=0.003)
        z, y = float(control.middle[2]), float(control.middle[1])
        span = 0.8 * width / 2
        half = (count + 1) // 2
        places = [y - span + 0.05 * 1.2 * k for k in range(half)]
        places += [y + span - 0.05 * 1.2 * k for k in range(count - half)]
        knob_row(b, knobs, face_x, z, sorted(places), radius=min(0.02, 0.3 * control_m))
        clock = (face_x + 0.0006, y, z)
        b.box(BLACK, (0.002, 0.1, 0.4 * control_m), clock, bevel=0.0005, collides=False)
        digits = (face_x + 0.0014, y, z)
        b.box(paint("#5fb7c9", 0.4), (0.002, 0.034, 0.012), digits, bevel=0.0003, collides=False)
    for number, share in enumerate((0.32, 0.62)):
        low = room.low[2] + share * room.size[2]
        rack = Box(
            (room.low[0] + 0.015, room.low[1] + 0.006, low),
            (room.high[0] - 0.012, room.high[1] - 0.006, low + 0.02),
        )
        name = f"{prefix}{('tray', 'rack')[number]}"
        with b.slide(name, "tray", by=round(0.6 * float(rack.size[0]), 3)):
            if number:
                wire_basket(b, STEEL, rack, pitch=0.026)
            else:
                _tray(b, ENAMEL, rack)
    panel = Box(
        (case.high[0] + 0.002, outer.low[1] + 0.002, outer.low[2] + 0.002),
        (face_x, outer.high[1] - 0.002, case.high[2] - 0.003),
    )
    flap(
        b,
        f"{prefix}door",
        face,
        "glass",
        panel,
        handle_kind="bar",
        metal_=grip,
        opens_deg=90.0,
        length=0.72 * width,
        pane=glass("#101214", 0.7),
        shut=SEAL,
    )


def _tray(b: PieceBuilder, material: PieceMaterial, room: Box) -> None:
    size, middle, wall = room.size, room.middle, 0.003
    b.box(
        material,
        (size[0], size[1], wall),
        (middle[0], middle[1], room.low[2] + wall / 2),
        bevel=0.001,
    )
    for sign in (-1.0, 1.0):
        at = (middle[0] + sign * (size[0] - wall) / 2, middle[1], middle[2])
        b.box(material, (wall, size[1], size[2]), at, bevel=0.001, collides=False)
        at = (middle[0], middle[1] + sign * (size[1] - wall) / 2, middle[2])
        b.box(material, (size[0], wall, size[2]), at, bevel=0.001, collides=False)


def dishwasher(
    b: PieceBuilder,
    outer: Box,
    *,
    body: PieceMaterial,
    face: PieceMaterial,
    grip: PieceMaterial,
    kind: FrontKind = "flat",
    handle_kind: str = "bar",
    panel: Box | None = None,
    strip: PieceMaterial | None = None,
    prefix: str = "",
) -> None:
    """Add a dishwasher: a case lined with steel, a door that folds down, baskets of dishes.

    Parameters
    ----------
    panel : Box or None
        The door, if it is not as large as the case.
    strip : PieceMaterial or None
        Of the panel with its lights, at the upper edge of its door.
    """
    thick = 0.03
    case = outer.within(high=(thick, 0.0, 0.0))
    room = hollow_case(b, body, case, 0.022, liner=STEEL)
    floor = float(room.low[2]) + 0.03
    tall = float(room.high[2]) - floor
    baskets = [("lower basket", floor, min(0.15, 0.4 * tall))]
    if tall > 0.5:
        baskets.append(("upper basket", floor + 0.55 * tall, 0.12))
    for name, low, height in baskets:
        basket = Box(
            (room.low[0] + 0.012, room.low[1] + 0.012, low),
            (room.high[0] - 0.014, room.high[1] - 0.012, low + height),
        )
        with b.slide(f"{prefix}{name}", "basket", by=round(0.75 * float(basket.size[0]), 3)):
            wire_basket(b, paint("#8d9296", 0.4), basket)
            if "upper" in name:
                _cups(b, basket)
            else:
                _standing_plates(b, basket)
    door = panel or Box(
        (case.high[0] + 0.002, outer.low[1] + 0.002, outer.low[2] + 0.002),
        (outer.high[0], outer.high[1] - 0.002, outer.high[2] - 0.002),
    )
    leaf = door if strip is None else door.within(high=(0.0, 0.0, 0.07))
    extra = (
        None
        if strip is None
        else (strip, Box((door.low[0], door.low[1], door.high[2] - 0.07), door.high))
    )
    flap(
        b,
        f"{prefix}door",
        face,
        kind,
        leaf,
        handle_kind=handle_kind,
        metal_=grip,
        opens_deg=90.0,
        length=0.7 * float(door.size[1]),
        extra=extra,
        shut=SEAL,
    )


def _standing_plates(b: PieceBuilder, basket: Box) -> None:
    glaze = paint(b.pick("#f0ece2", "#dfe5e6", "#c9d3c6", "#5d6a78"), 0.16, 2300.0)
    r = min(0.12, 0.4 * float(basket.size[1]))
    rows = [(0, 0), (0.55 * r, 0), (r, 0.016), (r, 0.019), (0.6 * r, 0.006), (0, 0.005)]
    plate = turned(rows, segments=24)
    with b.part("plates", "dish"):
        for number in range(int(b.rng.integers(4, 9))):
            x = basket.low[0] + 0.06 + 0.042 * number
            if x < basket.high[0] - 0.05:
                at = (x, basket.middle[1] + 0.1 * basket.size[1], basket.low[2] + r + 0.006)
                b.form(glaze, plate, at, turn=(0.0, 80.0, 0.0), collides="none")


def _cups(b: PieceBuilder, basket: Box) -> None:
    r, h = 0.036, 0.085
    rows = [(0, h), (r - 0.012, h), (r - 0.004, h - 0.02), (r, 0)][::-1]
    cup = turned([(r - 0.004, 0.0), *rows], segments=18)
    with b.part("cups", "cup"):
        for sy in (-1.0, 0.0, 1.0):
            for number in range(4):
                if b.chance(0.65):
                    glaze = paint(b.pick("#f0ece2", "#8fa0a8", "#b5533c"), 0.16, 2300.0)
                    x = basket.low[0] + 0.07 + 0.1 * number
                    y = basket.middle[1] + sy * 0.3 * basket.size[1]
                    if x < basket.high[0] - 0.04:
                        at = (x, y, basket.low[2] + 0.006)
                        b.form(glaze, cup, at, collides="none", volume=4e-5)


def glass_hob(b: PieceBuilder, x: float, y: float, z: float, *, width: float = 0.58) -> None:
    """Add a hob of black glass with four rings, that lies on a height."""
    with b.part("hob", "stove"):
        b.box(BLACK, (0.5, width, 0.006), (x, y, z + 0.003), bevel=0.002)
        ring = paint("#5c5f63", 0.4)
        for dx, dy, r in (
            (-0.11, -0.13, 0.09),
            (-0.11, 0.13, 0.07),
            (0.1, -0.13, 0.07),
            (0.1, 0.13, 0.1),
        ):
            rows = [(r - 0.002, 0.0), (r, 0.0), (r, 0.0006), (r - 0.002, 0.0006), (r - 0.002, 0.0)]
            at = (x + dx, y + dy * width / 0.58, z + 0.006)
            b.form(ring, turned(rows, segments=32), at, collides="none", volume=1e-6)
        for number in range(4):
            at = (x + 0.22, y - 0.06 + 0.04 * number, z + 0.0062)
            b.box(ring, (0.01, 0.012, 0.0008), at, bevel=0.0002, collides=False)


def gas_hob(
    b: PieceBuilder,
    x: float,
    y: float,
    z: float,
    *,
    width: float = 0.58,
    count: int = 4,
    plate: PieceMaterial = STEEL,
) -> None:
    """Add a hob with gas burners below iron grates, that lies on a height."""
    iron = paint("#1b1c1e", 0.7, 2500.0)
    rows = [
        (0, 0),
        (0.045, 0),
        (0.045, 0.01),
        (0.036, 0.012),
        (0.036, 0.02),
        (0.03, 0.023),
        (0, 0.023),
    ]
    with b.part("hob", "stove"):
        b.box(plate, (0.5, width, 0.012), (x, y, z + 0.006), bevel=0.004)
        columns = count // 2
        for column in range(columns):
            mid = y + ((column + 0.5) / columns - 0.5) * width
            for sx in (-1.0, 1.0):
                at = (x + sx * 0.12, mid, z + 0.012)
                b.form(iron, turned(rows, segments=20), at, collides="none")
                for turn in (0.0, 90.0):
                    bar = (0.22, 0.01, 0.012)
                    top = (at[0], mid, z + 0.045)
                    b.box(iron, bar, top, turn=(0, 0, turn), bevel=0.003, collides=False)
            span = width / columns - 0.05
            for sx in (-1.0, 1.0):
                edge = (x + sx * 0.23, mid, z + 0.045)
                b.box(iron, (0.01, span, 0.012), edge, bevel=0.003, collides=False)
                for sy in (-1.0, 1.0):
                    foot = (x + sx * 0.23, mid + sy * span / 2, z + 0.03)
                    b.box(iron, (0.012, 0.012, 0.04), foot, bevel=0.002, collides=False)
            for sy in (-1.0, 1.0):
                edge = (x, mid + sy * span / 2, z + 0.045)
                b.box(iron, (0.46, 0.01, 0.012), edge, bevel=0.003, collides=False)
            b.collide((0.46, span, 0.03), (x, mid, z + 0.036))
