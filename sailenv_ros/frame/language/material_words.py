"""Words for materials, by the names of those that are sure: unknown names have none."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["MATERIAL_WORDS", "material_word"]

MATERIAL_WORDS: Mapping[str, frozenset[str]] = {
    "wood": frozenset(
        ("oak", "light oak", "walnut", "beech", "birch", "teak", "cherry", "ash", "pine", "wenge",
         "mahogany", "black oak")
    ),
    "metal": frozenset(("chrome", "steel", "brass", "copper", "bronze", "alu")),
    "fabric": frozenset(("fabric",)),
    "leather": frozenset(("leather",)),
    "glass": frozenset(("glass",)),
}  # fmt: skip
"""Names of materials of each word; a colour, as in ``leather #7a4a2b``, is no part of them."""


def material_word(name: str) -> str:
    """Return the word for a material of a name; empty if it is not known what that is."""
    bare = name.partition(" #")[0]
    return next((word for word, names in MATERIAL_WORDS.items() if bare in names), "")
