"""Boxes and cartons, printed, wrapped or plain."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import Vector3, box, painted_part, printed_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["carton", "cereal_box", "gift_box", "shoe_box", "tissue_box"]


def carton() -> list[RawPart]:
    """Return a milk carton with a gable and a cap."""
    side, tall, ridge = 0.0475, 0.165, 0.205
    front = Sheet(300, 520, (0.95, 0.95, 0.94)).box(0, 0.62, 1, 1, (0.20, 0.42, 0.68))
    front.area(
        [(0, 0.62), (0.25, 0.55), (0.5, 0.62), (0.75, 0.56), (1, 0.62), (1, 0.66), (0, 0.66)],
        (0.20, 0.42, 0.68),
    )
    front.text("MILK", 0.5, 0.28, 0.10, (0.12, 0.28, 0.50)).text(
        "1 litre  3.5 %", 0.5, 0.90, 0.03, (0.92, 0.94, 0.96)
    )
    front.disc(0.5, 0.47, 0.055, (0.96, 0.96, 0.96)).disc(0.5, 0.48, 0.045, (0.88, 0.92, 0.96))
    parts = [
        painted_part(
            "card", box((2 * side, 2 * side, tall), (0, 0, tall / 2)), "#f0f0ee", roughness=0.4
        )
    ]
    for angle in (0.0, 90.0, 180.0, 270.0):
        face = forms.moved(forms.panel(tall, 2 * side, 0.0), turn_deg=(0.0, 90.0, 0.0))
        face = forms.moved(
            forms.moved(face, (side + 0.0004, 0.0, tall / 2)), turn_deg=(0, 0, angle)
        )
        parts.append(printed_part("print", face, front.texture(), roughness=0.4))
    a, b = np.array([side, side, tall]), np.array([side, -side, tall])
    c, d = a * [-1, 1, 1], b * [-1, 1, 1]
    e, f = np.array([0.0, side, ridge]), np.array([0.0, -side, ridge])
    inner = [np.array([0.0, y * 0.35, ridge - 0.012]) for y in (side, -side)]
    points = np.array([a, b, c, d, e, f, *inner])
    faces = np.array(
        [
            [0, 5, 1],
            [0, 4, 5],
            [3, 4, 2],
            [3, 5, 4],
            [0, 2, 6],
            [0, 6, 4],
            [2, 4, 6],
            [1, 7, 3],
            [1, 5, 7],
            [3, 7, 5],
        ]
    )
    roof = RawMesh(positions=points, uvs=np.zeros((8, 2)), triangles=faces)
    parts.append(painted_part("roof card", roof, "#e9eaea", roughness=0.4, double_sided=True))
    parts.append(
        painted_part("seam card", box((0.003, 2 * side, 0.020), (0, 0, ridge + 0.008)), "#e4e5e5")
    )
    cap = forms.lathe([(0.0135, 0.0), (0.0135, 0.010), (0.0125, 0.012), (0.0, 0.0122)], 28)
    slope = float(np.degrees(np.arctan2(ridge - tall, side)))
    cap = forms.moved(
        forms.moved(cap, turn_deg=(0.0, slope, 0.0)), (side / 2 + 0.0005, 0.0, (tall + ridge) / 2)
    )
    parts.append(painted_part("cap plastic", cap, "#2a5da0"))
    return forms.standing(parts)


def cereal_box() -> list[RawPart]:
    """Return a box of breakfast cereals."""
    front = Sheet(380, 560, (0.2, 0.4, 0.7)).shade((0.93, 0.74, 0.20), (0.86, 0.42, 0.12))
    front.area([(0.05, 0.10), (0.95, 0.05), (0.95, 0.27), (0.05, 0.31)], (0.62, 0.10, 0.12))
    front.text("CRUNCH", 0.5, 0.185, 0.105, (0.99, 0.95, 0.85))
    front.disc(0.5, 0.80, 0.27, (0.93, 0.94, 0.96)).disc(0.5, 0.80, 0.23, (0.97, 0.96, 0.92))
    generator = np.random.default_rng(2)
    for x, y in generator.uniform((0.24, 0.62), (0.76, 0.95), (70, 2)):
        front.disc(float(x), float(y), 0.022, (0.72, 0.46, 0.18)).disc(
            float(x), float(y), 0.008, (0.9, 0.8, 0.6)
        )
    front.box(0.06, 0.36, 0.36, 0.46, (0.95, 0.93, 0.86)).text(
        "whole grain", 0.21, 0.41, 0.03, (0.3, 0.3, 0.2)
    )
    return forms.standing(_printed_box((0.065, 0.190, 0.280), front, "#cf8a2c"))


def tissue_box() -> list[RawPart]:
    """Return a box of paper tissues, one of them pulled out."""
    front = Sheet(400, 180, (0.55, 0.70, 0.72))
    generator = np.random.default_rng(9)
    for x, y in generator.uniform((0.02, 0.05), (0.98, 0.95), (38, 2)):
        for k in range(6):
            a = k * np.pi / 3
            front.disc(
                float(x + 0.018 * np.cos(a)), float(y + 0.04 * np.sin(a)), 0.035, (0.90, 0.93, 0.90)
            )
        front.disc(float(x), float(y), 0.03, (0.93, 0.75, 0.40))
    parts = _printed_box((0.115, 0.225, 0.085), front, "#7fa3a6")
    slit = forms.moved(forms.slab(forms.rectangle(0.130, 0.040, 0.019), 0.0006), (0.0, 0.0, 0.085))
    parts.append(painted_part("slit", slit, "#dfe6e6"))
    across = np.linspace(-1.0, 1.0, 25)
    rings = []
    for k, z in enumerate((0.084, 0.098, 0.113, 0.130, 0.146)):
        wide = (0.030, 0.040, 0.052, 0.058, 0.050)[k]
        fold = (0.006, 0.010, 0.013, 0.012, 0.009)[k] * np.sin(5.5 * across + 0.7 * k) + 0.004 * k
        top = z + (0.008 * np.sin(4.0 * across) - 0.016 * across**2 if k > 2 else 0.0 * across)
        rings.append(np.stack([fold, wide * across, top], -1))
    tissue = forms.loft(np.array(rings), closed=False, caps=False)
    parts.append(painted_part("tissue", tissue, "#f3f3f1", roughness=0.95, double_sided=True))
    return forms.standing(parts)


def gift_box() -> list[RawPart]:
    """Return a present with a ribbon and a bow."""
    body = box((0.16, 0.20, 0.085), (0.0, 0.0, 0.0425))
    lid = box((0.166, 0.206, 0.028), (0.0, 0.0, 0.086))
    bands = [
        box((0.168, 0.022, 0.1005), (0, 0, 0.0505)),
        box((0.022, 0.208, 0.1005), (0, 0, 0.0505)),
    ]
    loops = []
    for angle in (20.0, 110.0, 200.0, 290.0):
        path = forms.curve(
            [
                (0.0, 0, 0.100),
                (0.030, 0, 0.128),
                (0.056, 0, 0.120),
                (0.040, 0, 0.103),
                (0.002, 0, 0.101),
            ],
            22,
        )
        rings = [[np.add(p, (0.0, s, 0.0)) for s in (-0.010, 0.010)] for p in path]
        loops.append(
            forms.moved(
                forms.loft(np.array(rings), closed=False, caps=False), turn_deg=(0, 0, angle)
            )
        )
    return forms.standing(
        [
            painted_part("wrapping paper", body, "#2f6f73", roughness=0.5),
            painted_part("lid wrapping paper", lid, "#357c80", roughness=0.5),
            painted_part("ribbon", forms.merged(bands), "#d9b14c", roughness=0.3),
            painted_part("bow", forms.merged(loops), "#d9b14c", roughness=0.3, double_sided=True),
            painted_part(
                "knot",
                forms.ellipsoid((0.011, 0.011, 0.008), (0, 0, 0.104), 16),
                "#cba243",
                roughness=0.3,
            ),
        ]
    )


def shoe_box() -> list[RawPart]:
    """Return a shoe box with its lid and a label."""
    label = (
        Sheet(200, 100, (0.95, 0.95, 0.93))
        .text("42", 0.8, 0.45, 0.4, (0.1, 0.1, 0.1))
        .lines(0.08, 0.25, 0.6, 4, 0.17, (0.3, 0.3, 0.32))
    )
    tag = forms.moved(forms.panel(0.035, 0.075, 0.0), turn_deg=(0.0, 90.0, 0.0))
    return forms.standing(
        [
            painted_part(
                "card", box((0.330, 0.190, 0.105), (0.0, 0.0, 0.0525)), "#b98252", roughness=0.8
            ),
            painted_part(
                "lid card", box((0.338, 0.198, 0.032), (0.0, 0.0, 0.106)), "#33363b", roughness=0.7
            ),
            printed_part("label", forms.moved(tag, (0.1656, 0.0, 0.052)), label.texture()),
        ]
    )


def _printed_box(size: Vector3, front: Sheet, colour: str) -> list[RawPart]:
    depth, width, height = size
    parts = [painted_part("card", box(size, (0.0, 0.0, height / 2)), colour, roughness=0.45)]
    for angle in (0.0, 180.0):
        face = forms.moved(forms.panel(height, width, 0.0), turn_deg=(0.0, 90.0, 0.0))
        face = forms.moved(
            forms.moved(face, (depth / 2 + 0.0004, 0.0, height / 2)), turn_deg=(0, 0, angle)
        )
        parts.append(printed_part("print", face, front.texture(), roughness=0.35))
    return parts
