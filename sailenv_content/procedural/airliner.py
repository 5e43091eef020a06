"""A model airliner: fuselage with its livery, swept wings, tail, engines."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import painted_part, printed_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["airliner"]

LENGTH_M = 0.40
RADIUS = 0.0526
"""Of the fuselage; this and all below are shares of its length, as an Airbus A320 has them."""

NOSE, TAIL = 0.13, 0.30
WHITE, BELLY, BLUE, TRIM = (
    (0.93, 0.94, 0.95),
    (0.06, 0.20, 0.46),
    (0.06, 0.20, 0.46),
    (0.85, 0.2, 0.13),
)
GLASS, LINE = (0.07, 0.09, 0.12), (0.62, 0.64, 0.67)


def airliner() -> list[RawPart]:
    """Return an airliner that looks along x, 40 cm long."""
    sides = (1.0, -1.0)
    wings = [_wing(side) for side in sides]
    tailplanes = [
        _surface([(-0.375, 0.01 * side, 0.022, 0.112), (-0.475, 0.168 * side, 0.040, 0.045)], 0.09)
        for side in sides
    ]
    fin = _surface([(-0.318, 0.0, 0.030, 0.160), (-0.462, 0.0, 0.215, 0.058)], 0.09, upright=True)
    pieces = [
        painted_part("wing paint", forms.merged([*wings, *tailplanes]), "#8b9198", roughness=0.35),
        printed_part("fin paint", fin, _fin_print().texture(), roughness=0.3),
        printed_part("fuselage paint", _fuselage(), _livery().texture(), roughness=0.25),
    ]
    for side in sides:
        pieces += _engine(side)
    return forms.standing(pieces, LENGTH_M)


def _fuselage() -> RawMesh:
    """Return the fuselage: round sections, the nose drooped and the tail swept up."""
    rings = []
    for t in np.linspace(1.0, 0.0, 16):
        radius = RADIUS * (1.0 - t**1.7) + 0.008 * t
        rings.append(_ring(-0.5 + TAIL * (1.0 - t), radius, 0.8 * (RADIUS - radius)))
    rings += [_ring(x, RADIUS, 0.0) for x in np.linspace(-0.5 + TAIL, 0.5 - NOSE, 10)[1:-1]]
    for s in np.cos(np.linspace(0.0, np.pi / 2.0, 18)):
        radius = max(1e-4, RADIUS * (1.0 - (1.0 - s) ** 2) ** 0.62)
        rings.append(_ring(0.5 - NOSE * s, radius, -0.016 * (1.0 - s) ** 2))
    return forms.loft(rings)


def _ring(x: float, radius: float, z: float) -> forms.Floats:
    return forms.upright_ring((x, 0.0, z), radius, radius, 40)


def _livery() -> Sheet:
    """Return what is painted on the fuselage: across from side to side over the top, nose up."""
    sheet = Sheet(512, 1536, WHITE)

    def along(x: float) -> float:
        """Return the sheet's row of a place along the fuselage, -0.5 to 0.5."""
        return 0.5 - x * 0.985

    sheet.box(0.54, 0.0, 0.96, 1.0, BELLY)
    for edge, inner in ((0.0, 1.0), (0.5, -1.0)):  # left and right flank at half height
        sheet.box(*_sorted_box(edge - inner * 0.018, edge + inner * 0.002, 0.06, 0.90), BLUE)
        sheet.box(*_sorted_box(edge - inner * 0.027, edge - inner * 0.020, 0.06, 0.90), TRIM)
        if edge == 0.0:  # what runs over the seam
            sheet.box(0.982, 0.06, 1.0, 0.90, BLUE)
            sheet.box(0.973, 0.06, 0.980, 0.90, TRIM)
        row = edge + inner * 0.035
        for x in np.arange(-0.30, 0.375, 0.0165):
            y = along(float(x))
            sheet.box(row - 0.010, y - 0.0028, row + 0.010, y + 0.0028, GLASS)
        for x in (0.392, 0.06, -0.335):  # doors
            y = along(x)
            sheet.box(
                *_sorted_box(edge - inner * 0.012, edge + inner * 0.072, y - 0.011, y + 0.011), LINE
            )
            sheet.box(
                *_sorted_box(edge - inner * 0.005, edge + inner * 0.067, y - 0.009, y + 0.009),
                WHITE,
            )
            sheet.box(row - 0.008, y - 0.003, row + 0.008, y + 0.003, GLASS)
    sheet.area([(0.0, 1.0), (0.0, 0.90), (0.25, 0.84), (0.5, 0.90), (0.5, 1.0)], BLUE)
    sheet.area([(0.5, 0.90), (0.75, 0.97), (1.0, 0.90), (1.0, 1.0), (0.5, 1.0)], BLUE)
    for left, right in (
        (0.075, 0.13),
        (0.137, 0.19),
        (0.197, 0.247),
        (0.253, 0.303),
        (0.31, 0.363),
        (0.37, 0.425),
    ):
        low = 0.072 if 0.19 < left < 0.31 else 0.078
        sheet.area([(left, low), (right, low), (right, low - 0.020), (left, low - 0.020)], GLASS)
    return sheet


def _sorted_box(a: float, b: float, top: float, bottom: float) -> tuple[float, float, float, float]:
    """Return left, top, right, bottom of a box between two columns."""
    return max(0.0, min(a, b)), top, min(1.0, max(a, b)), bottom


def _fin_print() -> Sheet:
    """Return what is painted on the fin: around its section, root down."""
    sheet = Sheet(256, 256, BLUE)
    for left in (0.0, 0.5):
        sheet.area([(left, 0.62), (left + 0.5, 0.30), (left + 0.5, 0.42), (left, 0.80)], TRIM)
        sheet.area([(left, 0.86), (left + 0.5, 0.50), (left + 0.5, 0.55), (left, 0.95)], WHITE)
    return sheet


def _wing(side: float) -> RawMesh:
    """Return a swept wing with a kink in its trailing edge and a winglet."""
    return _surface(
        [
            (0.122, 0.02 * side, -0.030, 0.190),
            (0.030, 0.175 * side, -0.017, 0.112),
            (-0.118, 0.455 * side, 0.008, 0.046),
            (-0.134, 0.478 * side, 0.016, 0.040),
            (-0.152, 0.490 * side, 0.034, 0.031),
            (-0.172, 0.496 * side, 0.064, 0.018),
        ],
        0.12,
    )


def _surface(sections: ArrayLike, thickness: float, *, upright: bool = False) -> RawMesh:
    """Return the skin over sections of x of the leading edge, y, z and chord.

    `thickness` is the sections' share of their chord; upright ones are thick along y.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 28, endpoint=False)
    along = 0.5 * (1.0 - np.cos(turn))  # 0 at the leading edge, twice around
    # NACA's symmetric four-digit section (Jacobs, Ward and Pinkerton 1933), closed at its end.
    half = 5.0 * thickness * (
        0.2969 * np.sqrt(along)
        - 0.1260 * along
        - 0.3516 * along**2
        + 0.2843 * along**3
        - 0.1036 * along**4
    )  # fmt: skip
    across = np.where(turn < np.pi, half, -half)
    rings = []
    for x, y, z, chord in np.asarray(sections, np.float64):
        zero = np.zeros(len(turn))
        section = [x - chord * along, y + zero, z + zero]
        section[1 if upright else 2] = section[1 if upright else 2] + chord * across
        rings.append(np.stack(section, axis=-1))
    return forms.loft(rings)


def _engine(side: float) -> list[RawPart]:
    """Return an engine under a wing: nacelle, fan, cone and pylon."""
    x, y, z = 0.102, 0.162 * side, -0.064
    outside = [(0.0200, 0.105), (0.0255, 0.085), (0.0300, 0.055), (0.0320, 0.025), (0.0310, 0.006),
               (0.0290, 0.0), (0.0265, 0.006), (0.0255, 0.018)]  # fmt: skip
    # The lathe turns about z; what is high there lies in front.
    nacelle = forms.lathe([(r, -h) for r, h in outside], 36)
    fan = forms.lathe([(0.0256, -0.017), (0.006, -0.015), (0.0, -0.006)], 36)
    core = forms.lathe([(0.0, -0.135), (0.008, -0.118), (0.0155, -0.104), (0.0195, -0.100)], 28)
    pylon = _surface(
        [(0.090, y, z + 0.024, 0.115), (0.058, y, z + 0.052, 0.090)], 0.10, upright=True
    )
    return [
        painted_part(
            "nacelle paint", forms.moved(nacelle, (x, y, z), (0, 90, 0)), "#173a7c", roughness=0.25
        ),
        painted_part("fan", forms.moved(fan, (x, y, z), (0, 90, 0)), "#1b1d20", roughness=0.35),
        painted_part("core metal", forms.moved(core, (x, y, z), (0, 90, 0)), "#6e6f72"),
        painted_part("pylon paint", pylon, "#8b9198", roughness=0.35),
    ]
