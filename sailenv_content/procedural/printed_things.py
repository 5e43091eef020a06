"""Paper and pictures: sheets, a letter, a magazine, a photograph in its frame."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import box, painted_part, printed_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["envelope", "magazine", "paper_stack", "photo_frame"]


def paper_stack() -> list[RawPart]:
    """Return printed sheets, the upper ones a little turned."""
    generator = np.random.default_rng(71)
    parts = []
    for k in range(7):
        sheet = box((0.297, 0.210, 0.0009), (0.0, 0.0, 0.0005 + 0.001 * k))
        angle = float(generator.normal(0.0, 2.4))
        parts.append(painted_part("paper", forms.moved(sheet, turn_deg=(0, 0, angle)), "#ecebe4"))
    print_ = Sheet(420, 594, (0.93, 0.925, 0.90))
    print_.text("Annual report", 0.5, 0.10, 0.035, (0.12, 0.12, 0.14))
    print_.lines(0.12, 0.18, 0.88, 18, 0.019, (0.42, 0.42, 0.43))
    print_.box(0.12, 0.56, 0.88, 0.76, (0.86, 0.89, 0.92))
    for k, tall in enumerate((0.05, 0.09, 0.07, 0.13, 0.16, 0.12)):
        left = 0.18 + 0.115 * k
        print_.box(left, 0.74 - tall, left + 0.06, 0.74, (0.20, 0.38, 0.60))
    print_.lines(0.12, 0.81, 0.88, 6, 0.019, (0.42, 0.42, 0.43))
    top = forms.moved(forms.panel(0.297, 0.210, 0.0072), turn_deg=(0.0, 0.0, angle))
    return forms.standing([*parts, printed_part("print paper", top, print_.texture())])


def envelope() -> list[RawPart]:
    """Return a letter with a stamp."""
    face = Sheet(440, 220, (0.90, 0.87, 0.80))
    face.lines(0.42, 0.50, 0.80, 4, 0.085, (0.16, 0.18, 0.35))
    face.box(0.84, 0.07, 0.95, 0.33, (0.95, 0.95, 0.92)).box(
        0.85, 0.09, 0.94, 0.31, (0.55, 0.16, 0.18)
    )
    face.disc(0.80, 0.24, 0.13, (0.72, 0.70, 0.66)).disc(0.80, 0.24, 0.115, (0.90, 0.87, 0.80))
    face.text("17.3.", 0.80, 0.24, 0.07, (0.35, 0.35, 0.36))
    return forms.standing(
        [
            painted_part(
                "paper", forms.slab(forms.rectangle(0.22, 0.11, 0.001), 0.0022, 0.0008), "#e2dccd"
            ),
            printed_part("address paper", forms.panel(0.108, 0.218, 0.0024), face.texture()),
        ]
    )


def magazine() -> list[RawPart]:
    """Return a magazine that lies with its cover up."""
    cover = Sheet(420, 560, (0.9, 0.9, 0.9)).shade((0.93, 0.72, 0.42), (0.30, 0.46, 0.55))
    cover.disc(0.68, 0.42, 0.12, (0.98, 0.90, 0.66))
    cover.area(
        [(0, 0.74), (0.22, 0.56), (0.40, 0.68), (0.62, 0.52), (1, 0.70), (1, 1), (0, 1)],
        (0.20, 0.30, 0.34),
    )
    cover.area(
        [(0, 0.86), (0.35, 0.74), (0.72, 0.84), (1, 0.78), (1, 1), (0, 1)], (0.12, 0.20, 0.22)
    )
    cover.text("HORIZON", 0.5, 0.12, 0.10, (0.98, 0.97, 0.94))
    cover.text("the quiet mountains", 0.36, 0.90, 0.028, (0.95, 0.94, 0.9))
    cover.text("12 walks for autumn", 0.36, 0.945, 0.022, (0.9, 0.9, 0.86))
    pages = forms.slab(forms.rectangle(0.208, 0.274, 0.001), 0.0058)
    bent = pages.positions.copy()
    bent[:, 2] += 0.0012 * np.cos(bent[:, 1] * 9.0)
    pages = RawMesh(positions=bent, uvs=pages.uvs, triangles=pages.triangles)
    return forms.standing(
        [
            painted_part("pages paper", box((0.274, 0.208, 0.0056), (0, 0, 0.0030)), "#e6e2d9"),
            printed_part(
                "cover", forms.panel(0.276, 0.210, 0.0062), cover.texture(), roughness=0.25
            ),
            painted_part("back paper", box((0.276, 0.210, 0.0004), (0, 0, 0.0002)), "#3d5a66"),
        ]
    )


def photo_frame() -> list[RawPart]:
    """Return a photograph in a frame that stands, looking along x."""
    photo = Sheet(300, 380, (1, 1, 1)).shade((0.62, 0.76, 0.88), (0.86, 0.90, 0.90))
    photo.area([(0, 0.62), (0.3, 0.50), (0.6, 0.60), (1, 0.52), (1, 1), (0, 1)], (0.35, 0.50, 0.28))
    for x, tall, shirt in ((0.36, 0.0, (0.70, 0.28, 0.24)), (0.64, 0.05, (0.22, 0.32, 0.52))):
        photo.area(
            [(x - 0.17, 1.0), (x - 0.13, 0.66 + tall), (x + 0.13, 0.66 + tall), (x + 0.17, 1.0)],
            shirt,
        )
        photo.disc(x, 0.52 + tall, 0.095, (0.86, 0.68, 0.56))
        photo.disc(x, 0.475 + tall, 0.085, (0.28, 0.18, 0.10)).disc(
            x, 0.535 + tall, 0.078, (0.86, 0.68, 0.56)
        )
    width, height, edge = 0.15, 0.19, 0.016
    bars = [
        box((0.014, width, edge), (0, 0, edge / 2)),
        box((0.014, width, edge), (0, 0, height - edge / 2)),
        box((0.014, edge, height - 2 * edge), (0, (width - edge) / 2, height / 2)),
        box((0.014, edge, height - 2 * edge), (0, -(width - edge) / 2, height / 2)),
    ]
    picture = forms.moved(
        forms.panel(height - 2 * edge, width - 2 * edge, 0.0), turn_deg=(0.0, 90.0, 0.0)
    )
    picture = forms.moved(picture, (0.002, 0.0, height / 2))
    parts = [
        painted_part("frame wood", forms.merged(bars), "#8b5e34"),
        printed_part("photograph", picture, photo.texture(), roughness=0.08),
        painted_part(
            "back", box((0.004, width - 0.01, height - 0.01), (-0.005, 0, height / 2)), "#2c2622"
        ),
    ]
    leg = forms.moved(
        box((0.003, 0.05, 0.11), (0.0, 0.0, 0.055)), (-0.078, 0.0, 0.0), (0.0, 18.0, 0.0)
    )
    tilted = [forms.moved_part(p, turn_deg=(0.0, -12.0, 0.0)) for p in parts]
    return forms.standing([*tilted, painted_part("leg", leg, "#2c2622")])
