"""What surfaces are made of: a table from materials' names to physically based ones.

The catalogues' materials know a colour and a highlight. Their names tell what they are: metal,
wood, fabric. `Material` in, `Material` out.
"""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass

import numpy as np

from sailenv_content.standard.patterns import PATTERNS, pattern_maps
from sailenv_ros.types.model import Material

__all__ = ["FINISHES", "Finish", "finish_of", "finished"]

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

_STEEL = (0.56, 0.55, 0.53)


def finish_of(name: str) -> str | None:
    """Return the kind that a material's name tells, or None."""
    words = re.split(r"[^a-z]+", re.sub(r"([a-z])([A-Z])", r"\1_\2", name).lower())
    for kind, finish in FINISHES.items():
        if any(word.startswith(start) for word in words for start in finish.words):
            return kind
    return None


def finished(
    material: Material,
    kind: str | None,
    *,
    colour: Vector3 | None = None,
    roughness: float | None = None,
    metallic: float | None = None,
    pattern: str | None = None,
) -> Material:
    """Return a material as its kind is, with what the recipe says besides.

    Parameters
    ----------
    kind : str or None
        In `FINISHES`; None keeps the catalogue's roughness.
    colour : (3,) tuple of float or None
        Linear; replaces colour and picture.
    """
    finish = FINISHES[kind] if kind else Finish(roughness=max(material.roughness, 0.3))
    bare = finish.metallic > 0.5
    if colour is not None:
        material = dataclasses.replace(material, base_colour_texture=None)
    elif finish.colour is not None:
        colour = finish.colour
        material = dataclasses.replace(material, base_colour_texture=None)
    elif bare and material.base_colour_texture is None and _is_grey(material):
        colour = _STEEL
    red, green, blue = material.base_colour[:3] if colour is None else colour
    material = _patterned(material, finish.pattern if pattern is None else pattern)
    return dataclasses.replace(
        material,
        base_colour=(red, green, blue, 1.0),
        roughness=finish.roughness if roughness is None else roughness,
        metallic=finish.metallic if metallic is None else metallic,
        alpha="mask" if material.alpha == "mask" else "opaque",
        double_sided=material.double_sided or finish.sheet,
    )


def _is_grey(material: Material) -> bool:
    """Tell if a metal has only a stand-in for its colour, and is not painted black."""
    colour = np.asarray(material.base_colour[:3])
    return bool(np.ptp(colour) < 0.15 * colour.max() and colour.max() > 0.15)


def _patterned(material: Material, pattern: str) -> Material:
    """Return a material that has no picture a fine structure."""
    if not pattern or material.base_colour_texture is not None:
        return material
    maps = pattern_maps(PATTERNS[pattern])
    return dataclasses.replace(
        material,
        base_colour_texture=maps["base_colour_texture"],
        normal_texture=maps.get("normal_texture"),
    )
