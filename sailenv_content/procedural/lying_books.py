"""Books that lie about: bound ones with a printed cover, and an open one."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural.forms import Floats, loft, merged, moved, panel, standing
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import Vector3, box, painted_part, printed_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["atlas", "novel", "open_book", "open_novel", "thriller"]

INK = (0.16, 0.16, 0.17)
PAGE = (0.93, 0.90, 0.83)


def novel() -> list[RawPart]:
    """Return a bound novel that lies with its cover up, its top towards -x."""
    cover = Sheet(320, 480, (0.78, 0.22, 0.16))
    cover.disc(0.5, 0.56, 0.19, (0.97, 0.80, 0.38))
    cover.area(
        [(0, 0.66), (0.3, 0.55), (0.55, 0.68), (0.8, 0.58), (1, 0.66), (1, 1), (0, 1)],
        (0.24, 0.10, 0.16),
    )
    cover.area([(0, 0.80), (0.4, 0.70), (0.7, 0.80), (1, 0.74), (1, 1), (0, 1)], (0.13, 0.06, 0.11))
    cover.text("THE LONG", 0.5, 0.13, 0.072, (0.99, 0.95, 0.86))
    cover.text("HARVEST", 0.5, 0.235, 0.085, (0.99, 0.95, 0.86))
    cover.text("Clara Winter", 0.5, 0.93, 0.040, (0.97, 0.80, 0.38))
    return _bound(0.235, 0.158, 0.034, cover, (0.60, 0.13, 0.10), "THE LONG HARVEST")


def thriller() -> list[RawPart]:
    """Return a thick paperback that lies with its cover up, its top towards -x."""
    cover = Sheet(320, 500, (0.07, 0.11, 0.20)).shade((0.05, 0.16, 0.30), (0.02, 0.03, 0.07))
    cover.area([(0.30, 1.0), (0.46, 0.50), (0.54, 0.50), (0.70, 1.0)], (0.85, 0.86, 0.82))
    cover.area([(0.36, 1.0), (0.48, 0.50), (0.52, 0.50), (0.64, 1.0)], (0.20, 0.23, 0.27))
    cover.disc(0.5, 0.44, 0.065, (0.98, 0.95, 0.80))
    cover.text("NORTH", 0.5, 0.13, 0.105, (0.96, 0.96, 0.94))
    cover.text("LIGHT", 0.5, 0.265, 0.105, (0.96, 0.96, 0.94))
    cover.text("J. M. HOLT", 0.5, 0.93, 0.050, (0.93, 0.30, 0.20))
    return _bound(0.198, 0.126, 0.031, cover, (0.05, 0.09, 0.17), "NORTH LIGHT", board=0.0008)


def atlas() -> list[RawPart]:
    """Return a large book of pictures that lies with its cover up, its top towards -x."""
    cover = Sheet(400, 520, (0.95, 0.94, 0.90))
    cover.box(0.08, 0.30, 0.92, 0.93, (0.45, 0.66, 0.78))
    cover.area(
        [
            (0.08, 0.72),
            (0.34, 0.46),
            (0.52, 0.64),
            (0.70, 0.50),
            (0.92, 0.70),
            (0.92, 0.93),
            (0.08, 0.93),
        ],
        (0.20, 0.36, 0.33),
    )
    cover.area(
        [(0.08, 0.84), (0.45, 0.74), (0.92, 0.82), (0.92, 0.93), (0.08, 0.93)], (0.80, 0.70, 0.46)
    )
    cover.text("GARDENS", 0.5, 0.115, 0.078, (0.10, 0.26, 0.24))
    cover.text("of the north", 0.5, 0.215, 0.046, (0.32, 0.36, 0.34))
    return _bound(0.290, 0.225, 0.026, cover, (0.12, 0.30, 0.28), "GARDENS")


def open_book() -> list[RawPart]:
    """Return an open book with pictures that lies, its pages' tops towards -x."""
    return _open(0.235, 0.162, "#7c1f24", pictured=True)


def open_novel() -> list[RawPart]:
    """Return an open book of text that lies, its pages' tops towards -x."""
    return _open(0.222, 0.146, "#1f3f5c", pictured=False)


def _open(depth: float, width: float, colour: str, *, pictured: bool) -> list[RawPart]:
    """Return an open book; `width` is that of one page."""
    low = 0.0025
    across = np.linspace(0.0, 1.0, 22)
    # The pages rise steeply from the middle and fall towards their edges.
    rise = 0.0205 * (1.0 - np.exp(-across / 0.06)) * (1.0 - 0.45 * across**1.6) + 0.002
    parts = []
    for side, number in ((-1.0, 0), (1.0, 1 if pictured else 2)):
        y = side * (0.001 + width * across)
        outline = np.concatenate(
            [np.stack([y, low + rise], -1), [(y[-1] + side * 0.004, low), (side * 0.001, low)]]
        )
        ends = [
            np.concatenate([np.full((len(outline), 1), x), outline], axis=-1)
            for x in (-depth / 2.0, depth / 2.0)
        ]
        parts.append(painted_part("pages paper", loft(ends), "#e9e2d0"))
        parts.append(
            printed_part(
                "page print", _sheet(depth, y, low + rise + 0.0003), _spread(number).texture()
            )
        )
    board = box((depth + 0.008, 2.0 * width + 0.022, 0.0024), (0.0, 0.0, 0.0012))
    parts.append(painted_part("cover", board, colour, roughness=0.5))
    return standing(parts)


def _sheet(depth: float, y: Floats, z: Floats) -> RawMesh:
    """Return an open page: its picture read from +x, left to right along y."""
    order = np.argsort(y)
    y, z = y[order], z[order]
    count = len(y)
    positions = np.concatenate(
        [np.stack([np.full(count, x), y, z], axis=-1) for x in (depth / 2.0, -depth / 2.0)]
    )
    u = (y - y[0]) / (y[-1] - y[0])
    uvs = np.concatenate([np.stack([u, np.full(count, v)], axis=-1) for v in (0.0, 1.0)])
    n = np.arange(count - 1)
    triangles = np.concatenate(
        [np.stack([n, n + 1, n + 1 + count], -1), np.stack([n, n + 1 + count, n + count], -1)]
    )
    return RawMesh(positions=positions, uvs=uvs, triangles=triangles)


def _spread(number: int) -> Sheet:
    """Return a printed page: 0 has a heading, 1 a picture, 2 text alone."""
    page = Sheet(360, 520, (0.96, 0.94, 0.89))
    if number == 0:
        page.text("Chapter Nine", 0.5, 0.115, 0.036, INK)
        page.lines(0.12, 0.19, 0.90, 18, 0.0245, (0.30, 0.30, 0.31))
        page.lines(0.12, 0.66, 0.90, 11, 0.0245, (0.30, 0.30, 0.31))
        page.text("142", 0.14, 0.95, 0.018, INK)
    elif number == 2:
        page.lines(0.10, 0.10, 0.88, 32, 0.0245, (0.30, 0.30, 0.31))
        page.text("87", 0.86, 0.95, 0.018, INK)
    else:
        page.box(0.10, 0.08, 0.88, 0.42, (0.60, 0.74, 0.84))
        page.area(
            [(0.10, 0.32), (0.34, 0.20), (0.58, 0.31), (0.88, 0.22), (0.88, 0.42), (0.10, 0.42)],
            (0.32, 0.44, 0.28),
        )
        page.disc(0.70, 0.15, 0.032, (0.98, 0.93, 0.75))
        page.lines(0.10, 0.48, 0.88, 17, 0.0245, (0.30, 0.30, 0.31))
        page.text("143", 0.86, 0.95, 0.018, INK)
    return page


def _bound(
    depth: float,
    width: float,
    height: float,
    front: Sheet,
    colour: Vector3,
    title: str,
    board: float = 0.0028,
) -> list[RawPart]:
    """Return a book of pages between boards, its back to -y, and what is printed on it."""
    red, green, blue = (round(255.0 * value) for value in colour)
    cloth = f"#{red:02x}{green:02x}{blue:02x}"
    over = 0.003 if board > 0.001 else 0.0
    boards = [
        box((depth, width, board), (0.0, 0.0, board / 2.0)),
        box((depth, width, board), (0.0, 0.0, height - board / 2.0)),
        box((depth, board, height), (0.0, -width / 2.0 + board / 2.0, height / 2.0)),
    ]
    pages = box(
        (depth - 2.0 * over - 0.0004, width - over - board, height - 2.0 * board),
        (0.0, (board - over) / 2.0, height / 2.0),
    )
    back = Sheet(480, 64, colour)
    back.text(title, 0.5, 0.5, 0.42, (0.95, 0.90, 0.74))
    spine = moved(panel(height - 0.004, depth - 0.006, 0.0), turn_deg=(0.0, 0.0, -90.0))
    spine = moved(spine, turn_deg=(90.0, 0.0, 0.0))
    spine = moved(spine, (0.0, -width / 2.0 - 0.0003, height / 2.0))
    return standing(
        [
            painted_part("cover", merged(boards), cloth, roughness=0.45),
            printed_part("pages paper", pages, _edges().texture(), roughness=0.95),
            printed_part(
                "cover print", panel(depth, width, height + 0.0003), front.texture(), roughness=0.35
            ),
            printed_part("spine print", spine, back.texture(), roughness=0.45),
        ]
    )


def _edges() -> Sheet:
    """Return the edges of many pages."""
    sheet = Sheet(64, 96, PAGE)
    random = np.random.default_rng(7)
    for row in np.arange(0.02, 1.0, 0.042):
        shade = float(random.uniform(0.62, 0.80))
        sheet.line((0.0, row), (1.0, row), 0.010, (shade, 0.96 * shade, 0.86 * shade))
    return sheet
