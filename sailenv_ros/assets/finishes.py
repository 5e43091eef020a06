"""Finishes of surfaces: a table from materials' names to physically based ones.

The catalogues' materials know a colour and a highlight. Their names tell what they are: metal,
wood, fabric. `Material` in, `Material` out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["FINISHES", "Finish", "finish_of"]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Finish:
    """One row of the table.

    Attributes
    ----------
    words : tuple of str
        A material whose name has one of them at the beginning of a word is of this kind.
    roughness, metallic : float
    colour : (3,) tuple of float or None
        Linear; replaces the catalogue's where that is only a stand-in.
    pattern : str
        Name in `patterns.PATTERNS` of a fine structure for surfaces without a picture; or empty.
    sheet : bool
        True for what is thin: drawn from both sides, and thinned out leaf by leaf.
    """

    words: tuple[str, ...] = ()
    roughness: float
    metallic: float = 0.0
    colour: Vector3 | None = None
    pattern: str = ""
    sheet: bool = False


# The order counts: the first row with a matching word is taken.
FINISHES: dict[str, Finish] = {
    "screen": Finish(words=("screen",), roughness=0.08, colour=(0.008, 0.008, 0.01)),
    "leaf": Finish(words=("leaf", "leav", "hoja"), roughness=0.55, sheet=True),
    "strings": Finish(words=("string",), roughness=0.5, colour=(0.8, 0.78, 0.66)),
    "chrome": Finish(words=("chrom", "cromo", "stainl"), roughness=0.12, metallic=1.0),
    "brushed": Finish(words=("brush", "alu", "galvan"), roughness=0.35, metallic=1.0),
    "gold": Finish(words=("gold", "brass", "laton"), roughness=0.25, metallic=1.0),
    "metal": Finish(
        words=("metal", "steel", "iron", "inox", "silver"), roughness=0.3, metallic=1.0
    ),
    "leather": Finish(words=("leather", "cuir", "piel"), roughness=0.5, pattern="leather"),
    "fabric": Finish(
        words=(
            "fabric",
            "textil",
            "tela",
            "tessuto",
            "cushion",
            "coverlet",
            "mattress",
            "sheet",
            "shade",
            "cloth",
            "estofa",
        ),
        roughness=0.95,
        pattern="weave",
    ),
    "pillow": Finish(words=("pillow", "leftpillow", "rightpillow"), roughness=0.95),
    "terry": Finish(words=("towel", "toalla", "carpet"), roughness=1.0, pattern="terry"),
    "ceramic": Finish(words=("ceramic", "porcelain", "faiance", "crockery"), roughness=0.15),
    "glass": Finish(words=("glass", "cristal", "vidrio"), roughness=0.06),
    "rubber": Finish(words=("rubber", "wheel", "tyre"), roughness=0.85),
    "wood": Finish(
        words=("wood", "oak", "venge", "wenge", "madera", "bois", "lan"),
        roughness=0.5,
    ),
    "soil": Finish(words=("soil", "dirt", "tierra", "earth"), roughness=1.0),
    "paper": Finish(words=("paper", "page", "book", "card"), roughness=0.9),
    "plastic": Finish(words=("plast",), roughness=0.4),
    "paint": Finish(words=("paint", "lacquer"), roughness=0.45),
}


def finish_of(name: str) -> str | None:
    """Return the kind that a material's name tells, or None."""
    words = re.split(r"[^a-z]+", re.sub(r"([a-z])([A-Z])", r"\1_\2", name).lower())
    for kind, finish in FINISHES.items():
        if any(word.startswith(start) for word in words for start in finish.words):
            return kind
    return None
