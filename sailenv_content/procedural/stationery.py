"""Pens, notebooks, books and a mirror."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural.shapes import Vector3, box, part, rod
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["books", "mirror", "notebook", "pen"]


def pen(body: Vector3, cap: Vector3) -> list[RawPart]:
    """Return a ball pen that lies along x."""
    r = 0.005
    return [
        part("body plastic", rod(r, 0.085, (-0.005, 0.0, r)), base_colour=(*body, 1.0)),
        part("cap plastic", rod(r * 1.12, 0.050, (-0.0725, 0.0, r * 1.12)), base_colour=(*cap, 1)),
        part("clip metal", box((0.040, 0.003, 0.0015), (-0.070, 0.0, 2.5 * r))),
        part("tip metal", rod(r * 0.9, 0.016, (0.0455, 0.0, r), end_radius=0.0008)),
    ]


def notebook(cover: Vector3) -> list[RawPart]:
    """Return a closed A5 notebook with an elastic band."""
    depth, width, height, board = 0.210, 0.148, 0.016, 0.0015
    leather = {"base_colour": (*cover, 1.0), "roughness": 0.6}
    pages = box((depth - 0.006, width - 0.004, height - 2 * board), (0.0, -0.001, height / 2))
    return [
        part("page paper", pages, base_colour=(0.86, 0.82, 0.72, 1.0)),
        part("cover", box((depth, width, board), (0.0, 0.0, board / 2)), **leather),
        part("cover", box((depth, width, board), (0.0, 0.0, height - board / 2)), **leather),
        part(
            "cover",
            box((depth, board, height), (0.0, width / 2 - board / 2, height / 2)),
            **leather,
        ),
        part(
            "band rubber",
            box((depth + 0.002, 0.006, height + 0.002), (0.0, -0.045, height / 2)),
            base_colour=(0.02, 0.02, 0.02, 1.0),
        ),
    ]


def books(number: int, count: int) -> list[RawPart]:
    """Return books piled up, each turned a little."""
    generator = np.random.default_rng(100 + number)
    covers = ((0.35, 0.05, 0.04), (0.03, 0.10, 0.22), (0.42, 0.30, 0.10), (0.05, 0.16, 0.09))
    parts, base = [], 0.0
    for k in range(count):
        depth, width = generator.uniform(0.19, 0.24), generator.uniform(0.13, 0.17)
        height, board = generator.uniform(0.018, 0.038), 0.002
        angle = generator.normal(0.0, 0.10) if k else 0.0
        cover: dict[str, object] = {
            "base_colour": (*covers[(k + number) % 4], 1.0),
            "roughness": 0.5,
        }
        pieces = [
            (
                "page paper",
                (depth - 0.008, width - 0.006, height - 2 * board),
                (0.0, -0.002, height / 2),
            ),
            ("cover", (depth, width, board), (0.0, 0.0, board / 2)),
            ("cover", (depth, width, board), (0.0, 0.0, height - board / 2)),
            ("cover", (depth, board, height), (0.0, width / 2, height / 2)),
        ]
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        for name, size, centre in pieces:
            mesh = box(size, centre)
            positions = mesh.positions + np.array([0.0, 0.0, base])
            positions[:, :2] = positions[:, :2] @ turn.T
            raw = RawMesh(positions=positions, uvs=mesh.uvs, triangles=mesh.triangles)
            paper: dict[str, object] = {"base_colour": (0.84, 0.79, 0.66, 1.0), "roughness": 0.9}
            look = paper if name.startswith("page") else cover
            parts.append(part(f"{name} {k}", raw, **look))
        base += height
    return parts


def mirror(width: float, height: float) -> list[RawPart]:
    """Return a bathroom mirror that hangs on the wall behind it and looks along x."""
    glass = box((0.006, width, height), (0.017, 0.0, height / 2))
    back = box((0.014, width - 0.06, height - 0.06), (0.007, 0.0, height / 2))
    return [
        part("silvering", glass, base_colour=(0.9, 0.92, 0.92, 1.0), metallic=1.0, roughness=0.02),
        part("back plastic", back, base_colour=(0.08, 0.08, 0.08, 1.0)),
    ]
