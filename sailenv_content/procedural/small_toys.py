"""Toys, a ball and an alarm clock."""

from __future__ import annotations

import dataclasses

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import painted_part, printed_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["alarm_clock", "rubber_duck", "tennis_ball", "toy_blocks"]


def rubber_duck() -> list[RawPart]:
    """Return a rubber duck."""
    body = forms.ellipsoid((0.045, 0.035, 0.028), (0.0, 0.0, 0.026), 32)
    points = body.positions.copy()
    tail = np.clip(-points[:, 0] / 0.045, 0.0, 1.0) ** 2
    points[:, 2] += 0.024 * tail
    points[:, 1] *= 1.0 - 0.35 * tail
    body = RawMesh(positions=points, uvs=body.uvs, triangles=body.triangles)
    wings = []
    for side in (1.0, -1.0):
        wing = forms.ellipsoid((0.024, 0.007, 0.014), (-0.006, side * 0.0335, 0.032), 20)
        wings.append(forms.moved(wing, (0, 0, 0), (0, 0, 0)))
    bill = forms.slab(
        np.array([(0.0, -0.012), (0.012, -0.011), (0.017, 0.0), (0.012, 0.011), (0.0, 0.012)]),
        0.008,
        0.0035,
    )
    parts = [
        painted_part("body rubber", m, "#edc21b", roughness=0.4)
        for m in (body, forms.ellipsoid((0.0265, 0.0255, 0.025), (0.022, 0.0, 0.068), 28), *wings)
    ]
    parts.append(
        painted_part("bill", forms.moved(bill, (0.043, 0.0, 0.061)), "#dd6b1e", roughness=0.4)
    )
    eyes = [
        forms.ellipsoid((0.0022, 0.0036, 0.0042), (0.0440, s * 0.0118, 0.0755), 12)
        for s in (1.0, -1.0)
    ]
    parts.append(painted_part("eye", forms.merged(eyes), "#0b0b0c", roughness=0.1))
    return forms.standing(parts)


def toy_blocks() -> list[RawPart]:
    """Return three wooden blocks with letters, one upon two."""
    parts = []
    places = ((0.0, -0.031, 0.0, 8.0), (0.004, 0.029, 0.0, -5.0), (0.0, 0.002, 0.046, 21.0))
    colours = ((0.78, 0.20, 0.16), (0.16, 0.42, 0.66), (0.22, 0.55, 0.28))
    for number, ((x, y, z, angle), colour, letter) in enumerate(
        zip(places, colours, "ABC", strict=True), 1
    ):
        block = forms.slab(forms.rectangle(0.046, 0.046, 0.004), 0.046, 0.003)
        placed = forms.moved(block, (x, y, z), (0, 0, angle))
        parts.append(painted_part(f"block {number} wood", placed, "#d8b384"))
        face = Sheet(128, 128, (0.85, 0.70, 0.50)).box(0.06, 0.06, 0.94, 0.94, colour)
        face.box(0.12, 0.12, 0.88, 0.88, (0.87, 0.73, 0.54)).text(letter, 0.5, 0.5, 0.56, colour)
        for k in range(4):
            side = forms.moved(forms.panel(0.037, 0.037, 0.0), turn_deg=(0, 90, 0))
            side = forms.moved(forms.moved(side, (0.0233, 0, 0.023)), turn_deg=(0, 0, 90.0 * k))
            parts.append(
                printed_part(
                    f"letter {number}",
                    forms.moved(side, (x, y, z), (0, 0, angle)),
                    face.texture(),
                    roughness=0.6,
                )
            )
        top = forms.moved(forms.panel(0.037, 0.037, 0.0463), (x, y, z), (0, 0, angle))
        parts.append(printed_part(f"letter {number}", top, face.texture(), roughness=0.6))
    return forms.standing(parts)


def tennis_ball() -> list[RawPart]:
    """Return a tennis ball with its seam."""
    ball = forms.ellipsoid((0.0327, 0.0327, 0.0327), (0, 0, 0.0327), 32)
    t = np.linspace(0, 2 * np.pi, 96, endpoint=False)
    a, b = 0.75, 0.25
    seam = np.stack(
        [
            a * np.sin(t) + b * np.sin(3 * t),
            a * np.cos(t) - b * np.cos(3 * t),
            2 * np.sqrt(a * b) * np.cos(2 * t),
        ],
        -1,
    )
    seam = 0.0325 * seam / np.linalg.norm(seam, axis=1)[:, None] + [0, 0, 0.0327]
    return forms.standing(
        [
            painted_part("felt", ball, "#bfd434", roughness=1.0),
            painted_part(
                "seam", forms.tube(seam, 0.0011, sides=6, closed=True), "#ecefe2", roughness=0.8
            ),
        ]
    )


def alarm_clock() -> list[RawPart]:
    """Return an alarm clock with two bells that stands and looks along x."""
    dial = Sheet(320, 320, (0.95, 0.93, 0.87))
    for minute in range(60):
        a = np.radians(6.0 * minute)
        ends = [
            (0.5 + r * np.sin(a), 0.5 - r * np.cos(a))
            for r in (0.46 if minute % 5 else 0.43, 0.475)
        ]
        dial.line(ends[0], ends[1], 0.008 if minute % 5 else 0.018, (0.1, 0.1, 0.1))
    for hour in range(1, 13):
        a = np.radians(30.0 * hour)
        dial.text(str(hour), 0.5 + 0.35 * np.sin(a), 0.5 - 0.35 * np.cos(a), 0.085, (0.1, 0.1, 0.1))
    dial.line((0.5, 0.5), (0.34, 0.36), 0.030, (0.08, 0.08, 0.08)).line(
        (0.5, 0.5), (0.62, 0.16), 0.020, (0.08, 0.08, 0.08)
    )
    dial.disc(0.5, 0.5, 0.03, (0.08, 0.08, 0.08))
    body = forms.lathe(
        [
            (0.0, -0.025),
            (0.046, -0.025),
            (0.050, -0.020),
            (0.050, 0.020),
            (0.047, 0.025),
            (0.0445, 0.025),
            (0.0440, 0.021),
            (0, 0.021),
        ],
        44,
    )
    body = forms.moved(body, (0.0, 0.0, 0.062), (0.0, 90.0, 0.0))
    ring = forms.circle(44)
    face = RawMesh(
        positions=np.concatenate(
            [
                [[0.0214, 0, 0.062]],
                np.stack(
                    [np.full(44, 0.0214), -0.0442 * ring[:, 0], 0.062 + 0.0442 * ring[:, 1]], -1
                ),
            ]
        ),
        uvs=np.concatenate([[[0.5, 0.5]], 0.5 + 0.5 * ring * [-1.0, 1.0]]),
        triangles=np.stack(
            [np.zeros(44, np.int64), 1 + (np.arange(44) + 1) % 44, 1 + np.arange(44)], -1
        ),
    )
    across = 0.5 + 0.5 * face.positions[:, 1] / 0.0442
    face = dataclasses.replace(face, uvs=np.stack([across, face.uvs[:, 1]], -1))
    parts = [
        painted_part("body paint", body, "#8f2621", roughness=0.25),
        printed_part("dial", face, dial.texture(), roughness=0.2),
    ]
    for side in (1.0, -1.0):
        bell = forms.lathe(
            [(0.0215, 0.0), (0.0205, 0.008), (0.014, 0.016), (0.004, 0.0195), (0.0, 0.020)], 28
        )
        parts.append(
            painted_part(
                "bell brass",
                forms.moved(
                    forms.moved(bell, turn_deg=(-32.0 * side, 0, 0)), (0, side * 0.031, 0.105)
                ),
                "#b9944a",
            )
        )
        stem = forms.tube([(0, side * 0.026, 0.098), (0, side * 0.034, 0.110)], 0.0024, sides=8)
        foot = forms.tube(
            [(0.0, side * 0.028, 0.026), (0.008, side * 0.046, 0.0035)], [0.0045, 0.0030], sides=10
        )
        parts += [
            painted_part("stem metal", stem, "#9b9da0"),
            painted_part("foot metal", foot, "#9b9da0"),
        ]
    arch = forms.tube(
        forms.curve(
            [(0, -0.034, 0.128), (0, -0.020, 0.142), (0, 0.020, 0.142), (0, 0.034, 0.128)], 20
        ),
        0.0022,
        sides=8,
    )
    hammer = forms.tube([(0, 0, 0.110), (0, 0, 0.124)], [0.0018, 0.0018], sides=8)
    parts += [
        painted_part("arch metal", arch, "#9b9da0"),
        painted_part(
            "hammer metal",
            forms.merged([hammer, forms.ellipsoid((0.004, 0.006, 0.004), (0, 0, 0.125), 14)]),
            "#8b8d90",
        ),
    ]
    return forms.standing(parts)
