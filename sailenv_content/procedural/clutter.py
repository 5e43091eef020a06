"""Everyday things by their names in the recipe."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from sailenv_content.procedural import (
    bath_things,
    boxes,
    brushes,
    clothes,
    cutlery,
    food,
    gadgets,
    lying_books,
    office_things,
    pocket_things,
    printed_things,
    small_toys,
    vessels,
)
from sailenv_ros.assets.model_files import RawPart

__all__ = ["CLUTTER"]

_MODULES = (
    *(bath_things, boxes, brushes, clothes, cutlery, food, gadgets, office_things, pocket_things),
    *(printed_things, lying_books, small_toys, vessels),
)

CLUTTER: dict[str, Callable[[], list[RawPart]]] = {
    **{name: getattr(module, name) for module in _MODULES for name in module.__all__},
    "black_cable": partial(gadgets.cable, "#1d1e20"),
    "red_binder": partial(office_things.binder, "#8c2a2a"),
}
"""Maker of each: every function that those modules export is one."""
