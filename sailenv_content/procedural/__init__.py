"""Objects that code makes because no catalogue has them: paintings, cushions, pens, notebooks.

Each maker gives `RawPart`s in the body frame, origin at the centre of the base (of what hangs on a
wall: at the lower middle of its back). All that is random comes from a seeded generator.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from sailenv_content.procedural.airliner import airliner
from sailenv_content.procedural.clutter import CLUTTER
from sailenv_content.procedural.devices import computer, keyboard, monitor, mouse, stove, whiteboard
from sailenv_content.procedural.paintings import painting
from sailenv_content.procedural.rackets import tennis_racket
from sailenv_content.procedural.shelf_books import shelf_books
from sailenv_content.procedural.stationery import books, mirror, notebook, pen
from sailenv_content.procedural.textiles import cushion, folded_towel, hanging_towel, rug
from sailenv_ros.assets.model_files import RawPart

__all__ = ["PROCEDURAL"]

PROCEDURAL: dict[str, Callable[[], list[RawPart]]] = {
    "painting_landscape": partial(painting, 4, 0.90, 0.62, (0.10, 0.055, 0.025)),
    "painting_blocks": partial(painting, 5, 0.60, 0.80, (0.02, 0.02, 0.02)),
    "painting_washes": partial(painting, 6, 0.70, 0.70, (0.75, 0.72, 0.66)),
    "painting_flowers": partial(painting, 7, 0.50, 0.40, (0.55, 0.36, 0.10)),
    "cushion_teal": partial(cushion, 0.45, 0.45, 0.14, (0.03, 0.16, 0.18)),
    "cushion_ochre": partial(cushion, 0.40, 0.40, 0.13, (0.50, 0.25, 0.04)),
    "pillow_white": partial(cushion, 0.70, 0.45, 0.15, (0.80, 0.79, 0.76)),
    "folded_towels": partial(
        folded_towel, 0.36, 0.24, 3, ((0.72, 0.71, 0.68), (0.08, 0.20, 0.26), (0.62, 0.50, 0.36))
    ),
    "hand_towel": partial(hanging_towel, 0.42, 0.55, (0.10, 0.24, 0.30)),
    "bath_towel": partial(hanging_towel, 0.60, 0.80, (0.74, 0.72, 0.66)),
    "pen_blue": partial(pen, (0.75, 0.75, 0.76), (0.02, 0.08, 0.40)),
    "pen_red": partial(pen, (0.04, 0.04, 0.04), (0.45, 0.02, 0.02)),
    "notebook_black": partial(notebook, (0.02, 0.02, 0.022)),
    "notebook_red": partial(notebook, (0.32, 0.03, 0.03)),
    "books_pile": partial(books, 1, 4),
    "shelf_books": shelf_books,
    "rug_oriental": partial(rug, 2.4, 1.6, "oriental"),
    "rug_striped": partial(rug, 1.8, 1.2, "striped"),
    "mirror": partial(mirror, 0.60, 0.80),
    **CLUTTER,
    "airliner": airliner,
    "tennis_racket": tennis_racket,
    "stove": stove,
    "monitor": partial(monitor, 0.54, 0.32, 1),
    "wide_monitor": partial(monitor, 0.71, 0.33, 2),
    "keyboard": partial(keyboard, (0.015, 0.015, 0.016), (0.035, 0.035, 0.037)),
    "white_keyboard": partial(keyboard, (0.62, 0.62, 0.62), (0.80, 0.80, 0.79)),
    "mouse": partial(mouse, (0.02, 0.02, 0.021)),
    "white_mouse": partial(mouse, (0.78, 0.78, 0.77)),
    "computer": computer,
    "whiteboard": partial(whiteboard, 1.8, 1.2),
}
"""Maker of each object by its name in the recipe."""
