"""Materials of pieces: woods, metals, fabrics, glass, with density and finish.

A name and a colour in, a `PieceMaterial` out, the same object each time: the families name a
limited number of them. Fine structures are the catalogue's own patterns.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from sailenv_content.procedural.shapes import colour_of
from sailenv_content.standard.patterns import PATTERNS, pattern_maps
from sailenv_ros.types.model import Material, Texture

__all__ = [
    "FABRICS",
    "LEATHERS",
    "METAL_NAMES",
    "WOODS",
    "PieceMaterial",
    "colour_of",
    "fabric",
    "glass",
    "glow",
    "leather",
    "metal",
    "paint",
    "printed",
    "veil",
    "wood",
]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, eq=False, slots=True)
class PieceMaterial:
    """A material, the size of what its textures show, and its density.

    Attributes
    ----------
    surface : Material
    tile_m : float
        Edge of what the texture shows [m].
    density : float
        Mean, hollows of a real piece counted in [kg/m³].
    """

    surface: Material
    tile_m: float
    density: float


_WOODS = {
    "oak": "#b98d5c",
    "light oak": "#cfae80",
    "walnut": "#6b4630",
    "beech": "#cda478",
    "birch": "#dcc49c",
    "teak": "#94633a",
    "cherry": "#8e5233",
    "ash": "#d3bd98",
    "pine": "#d6b075",
    "wenge": "#3b2a22",
    "mahogany": "#6d3524",
    "black oak": "#2b2623",
}

_METALS: dict[str, tuple[str, float]] = {
    "chrome": ("#d9dadc", 0.10),
    "steel": ("#b6b8ba", 0.30),
    "brass": ("#c9a45c", 0.24),
    "copper": ("#c27a52", 0.26),
    "bronze": ("#7d6242", 0.34),
    "alu": ("#c4c6c8", 0.38),
}


def _patterned(
    name: str, pattern: str, colour: str, roughness: float, density: float
) -> PieceMaterial:
    maps = pattern_maps(PATTERNS[pattern])
    made = Material(
        name=name,
        base_colour=(*colour_of(colour), 1.0),
        roughness=roughness,
        base_colour_texture=maps["base_colour_texture"],
        normal_texture=maps.get("normal_texture"),
    )
    return PieceMaterial(made, PATTERNS[pattern].tile_m, density)


@cache
def wood(species: str) -> PieceMaterial:
    """Return a wood with its grain along u."""
    return _patterned(species, "grain", _WOODS[species], 0.48, 600.0)


@cache
def paint(colour: str, roughness: float = 0.42, density: float = 600.0) -> PieceMaterial:
    """Return a lacquer on board, or plastic."""
    made = Material(
        name=f"paint {colour}", base_colour=(*colour_of(colour), 1.0), roughness=roughness
    )
    return PieceMaterial(made, 1.0, density)


@cache
def metal(kind: str, density: float = 2500.0) -> PieceMaterial:
    """Return a metal by name, or one that is powder-coated in ``#rrggbb``.

    Tubes are drawn as rods and cases of sheet as boards, hence the densities.
    """
    if kind.startswith("#"):
        made = Material(name=f"coated {kind}", base_colour=(*colour_of(kind), 1.0), roughness=0.5)
        return PieceMaterial(made, 1.0, density)
    colour, roughness = _METALS[kind]
    made = Material(
        name=kind, base_colour=(*colour_of(colour), 1.0), metallic=1.0, roughness=roughness
    )
    return PieceMaterial(made, 1.0, density)


@cache
def fabric(colour: str) -> PieceMaterial:
    """Return upholstery."""
    return _patterned(f"fabric {colour}", "weave", colour, 0.95, 70.0)


@cache
def leather(colour: str) -> PieceMaterial:
    """Return leather over foam."""
    return _patterned(f"leather {colour}", "leather", colour, 0.5, 80.0)


@cache
def glass(colour: str = "#dfe8e6", opacity: float = 0.04) -> PieceMaterial:
    """Return clear or tinted glass; its opacity is the share that scatters."""
    made = Material(
        name=f"glass {colour}",
        base_colour=(*colour_of(colour), opacity),
        roughness=0.06,
        alpha="blend",
    )
    return PieceMaterial(made, 1.0, 2500.0)


def veil(colour: str, opacity: float) -> PieceMaterial:
    """Return thin cloth that is seen through; its opacity is the share that threads cover."""
    made = Material(
        name=f"veil {colour}", base_colour=(*colour_of(colour), opacity), roughness=0.95,
        alpha="blend",
    )  # fmt: skip
    return PieceMaterial(made, 1.0, 300.0)


def printed(
    name: str, picture: Texture, roughness: float = 0.8, density: float = 700.0
) -> PieceMaterial:
    """Return paper, canvas or what is woven with a picture, whose u and v go from 0 to 1."""
    made = Material(
        name=name, base_colour_texture=picture, base_colour=(1.0,) * 4, roughness=roughness
    )
    return PieceMaterial(made, 1.0, density)


@cache
def glow(colour: str, strength: float) -> PieceMaterial:
    """Return a shade or a bulb that glows by the light of its lamp."""
    red, green, blue = colour_of(colour)
    made = Material(
        name=f"shade {colour}",
        base_colour=(red, green, blue, 1.0),
        roughness=0.9,
        glow=(strength * red, strength * green, strength * blue),
        double_sided=True,
    )
    return PieceMaterial(made, 1.0, 300.0)


WOODS = tuple(wood(n) for n in ("oak", "walnut", "beech", "teak", "ash", "black oak", "cherry"))
FABRICS = tuple(
    fabric(c)
    for c in (
        "#6f7a83",
        "#8a3b32",
        "#c9bda8",
        "#3d5a5c",
        "#b98a3e",
        "#4a4a52",
        "#7c8a6a",
        "#a5604a",
    )
)
METAL_NAMES = frozenset(_METALS)
LEATHERS = tuple(leather(c) for c in ("#6b3f24", "#2a2624", "#a0703f", "#d8cdb8"))
