"""A tennis racket with its strings."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.shapes import painted_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["tennis_racket"]

LENGTH_M = 0.685
HEAD_M = (0.1620, 0.1210)
"""Half the length and half the width of the head, to the middle of its frame."""
FRAME_M, FRAME_TALL = 0.0080, 1.4
STRING_M = 0.0011
MAINS, CROSSES = 16, 19
PITCH_M = 0.019
"""From one turn of the grip's tape to the next."""


def tennis_racket() -> list[RawPart]:
    """Return a tennis racket that lies, its head towards x."""
    middle = LENGTH_M / 2.0 - HEAD_M[0] - FRAME_M
    ring = forms.circle(96)
    head = np.stack(
        [middle + HEAD_M[0] * ring[:, 0], HEAD_M[1] * ring[:, 1], np.zeros(96)], axis=-1
    )
    turn = np.degrees(np.arctan2(ring[:, 1], ring[:, 0]))
    accents = [
        forms.tube(head[(low <= turn) & (turn <= low + 34.0)], 1.06 * FRAME_M, sides=12)
        for low in (28.0, -62.0)
    ]
    shafts = [
        forms.tube(
            forms.curve(
                [
                    (middle - 0.128, side * 0.0745, 0.0),
                    (middle - 0.185, side * 0.0390, 0.0),
                    (middle - 0.235, side * 0.0135, 0.0),
                    (-0.120, side * 0.0085, 0.0),
                ],
                28,
            ),
            FRAME_M,
            sides=12,
        )
        for side in (1.0, -1.0)
    ]
    frame = forms.merged([forms.tube(head, FRAME_M, sides=12, closed=True), *shafts])
    collar = forms.moved(
        forms.lathe([(0.0160, 0.0), (0.0175, 0.004), (0.0175, 0.012), (0.0150, 0.016)], 24),
        (-0.146, 0.0, 0.0),
        (0.0, 90.0, 0.0),
    )
    return forms.standing(
        [
            painted_part("frame paint", _tall(frame), "#b3161d", roughness=0.25),
            painted_part("accent paint", _tall(forms.merged(accents)), "#f2f2ee", roughness=0.25),
            painted_part("strings", _strings(middle), "#f4f3ec", roughness=0.4),
            painted_part("grip tape", _grip(), "#17181a", roughness=0.8),
            painted_part("collar rubber", collar, "#17181a"),
        ]
    )


def _tall(mesh: RawMesh) -> RawMesh:
    """Return a frame as it is across the strings: taller than it is wide."""
    positions = mesh.positions * [1.0, 1.0, FRAME_TALL]
    return RawMesh(positions=positions, uvs=mesh.uvs, triangles=mesh.triangles)


def _strings(middle: float) -> RawMesh:
    """Return the strings: some along the racket, some across, each over and under the others."""
    strings = []
    for number, y in enumerate(np.linspace(-0.80, 0.80, MAINS) * HEAD_M[1]):
        reach = HEAD_M[0] * np.sqrt(1.0 - (y / HEAD_M[1]) ** 2)
        high = STRING_M * (0.6 if number % 2 else -0.6)
        strings.append(
            forms.tube([(middle - reach, y, high), (middle + reach, y, high)], STRING_M, sides=5)
        )
    for number, x in enumerate(np.linspace(-0.84, 0.84, CROSSES) * HEAD_M[0]):
        reach = HEAD_M[1] * np.sqrt(1.0 - (x / HEAD_M[0]) ** 2)
        high = STRING_M * (0.6 if number % 2 else -0.6)
        strings.append(
            forms.tube([(middle + x, -reach, high), (middle + x, reach, high)], STRING_M, sides=5)
        )
    return forms.merged(strings)


def _grip() -> RawMesh:
    """Return the handle: eight-sided, wound with tape, its butt wider."""
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    # The radius of an octagon, its flats up and to the sides.
    flat = np.cos(np.pi / 8.0) / np.cos((turn + np.pi / 8.0) % (np.pi / 4.0) - np.pi / 8.0)
    rings = []
    for x in np.linspace(-LENGTH_M / 2.0, -0.135, 70):
        butt = 0.0030 * np.exp(-(((x + LENGTH_M / 2.0 - 0.004) / 0.007) ** 2))
        wound = (x / PITCH_M - turn / (2.0 * np.pi)) % 1.0
        radius = (0.0155 + butt) * flat - 0.0007 * (wound < 0.12)
        rings.append(
            np.stack(
                [np.full(24, x), 0.92 * radius * np.cos(turn), 1.04 * radius * np.sin(turn)], -1
            )
        )
    return forms.loft(rings)
