"""A stove, screens, keyboards, mice, a computer and a whiteboard."""

from __future__ import annotations

import dataclasses

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_content.procedural.shapes import Vector3, box, part, raw_mesh, rod
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.assets.solids import cylinder_mesh, sphere_mesh
from sailenv_ros.types.model import Texture

__all__ = [
    "SCREEN_BLACK",
    "SCREEN_WHITE",
    "computer",
    "desktop_picture",
    "keyboard",
    "monitor",
    "mouse",
    "stove",
    "whiteboard",
]

SCREEN_BLACK = (0.02, 0.02, 0.022)
"""Reflectance of the white of its picture."""

SCREEN_WHITE = (0.45, 0.47, 0.5)
"""Radiance of the white of a screen that is on: about that of a white wall in daylight."""

_BLACK = {"base_colour": (0.012, 0.012, 0.013, 1.0)}


def stove() -> list[RawPart]:
    """Return a free-standing stove, 60 cm wide: hob with four rings, oven, knobs."""
    wide, deep, tall = 0.596, 0.60, 0.89
    white = {"base_colour": (0.78, 0.78, 0.76, 1.0), "roughness": 0.25}
    front = deep / 2.0
    parts = [
        part("enamel", box((deep - 0.03, wide, tall - 0.09), (-0.015, 0, 0.45)), **white),
        part("plinth", box((deep - 0.09, wide - 0.02, 0.05), (-0.045, 0, 0.025)), **_BLACK),
        part("panel", box((0.03, wide, 0.10), (front - 0.015, 0, 0.795)), **white),
        part("hob", box((deep, wide, 0.03), (0, 0, tall - 0.03)), **white),
        part("hob screen", box((deep - 0.05, wide - 0.04, 0.008), (0, 0, tall - 0.013))),
        part("door", box((0.028, wide - 0.008, 0.50), (front - 0.014, 0, 0.485)), **white),
        part("window screen", box((0.004, wide - 0.15, 0.27), (front + 0.001, 0, 0.47))),
        part("drawer", box((0.028, wide - 0.008, 0.165), (front - 0.014, 0, 0.145)), **white),
        part("rail brushed", box((0.014, wide - 0.12, 0.014), (front + 0.035, 0, 0.69))),
    ]
    for y in (-0.2, 0.2):
        parts.append(part("rail brushed", rod(0.006, 0.04, (front + 0.015, y, 0.69))))
    for x, y, radius in ((-0.13, 0.14, 0.075), (-0.13, -0.14, 0.095),
                         (0.13, 0.14, 0.095), (0.13, -0.14, 0.075)):  # fmt: skip
        for share, height in ((1.0, 0.0015), (0.93, 0.003)):
            disc = _disc(share * radius, height, (x, y, tall - 0.009 + height / 2.0))
            look = {"base_colour": (0.16, 0.16, 0.17, 1.0), "roughness": 0.4}
            parts.append(
                part(
                    "ring",
                    disc,
                    **(look if share == 1.0 else _BLACK),
                )
            )
    for y in (-0.22, -0.13, 0.04, 0.13, 0.22):
        parts.append(part("knob brushed", rod(0.019, 0.024, (front + 0.012, y, 0.795))))
        parts.append(part("mark", box((0.026, 0.003, 0.022), (front + 0.0135, y, 0.802)), **_BLACK))
    clock = box((0.004, 0.07, 0.035), (front + 0.001, -0.045, 0.795))
    parts.append(part("clock screen", clock))
    return parts


def monitor(wide: float, tall: float, number: int) -> list[RawPart]:
    """Return a screen on a foot, on which a program shows."""
    low, deep = 0.10, 0.024
    dark = {"base_colour": (0.02, 0.02, 0.022, 1.0), "roughness": 0.45}
    shown = _face(wide - 0.02, tall - 0.026, (deep / 2 + 0.0012, 0.0, low + tall / 2 + 0.004))
    picture = desktop_picture(number, wide / tall)
    return [
        part("case plastic", box((deep, wide, tall), (0, 0, low + tall / 2)), **dark),
        part(
            "display",
            shown,
            base_colour=(*SCREEN_BLACK, 1.0),
            base_colour_texture=picture,
            roughness=0.25,
            emission=SCREEN_WHITE,
        ),
        part("back plastic", box((0.03, wide / 2, tall / 2), (-0.026, 0, low + tall / 2)), **dark),
        part("stem brushed", box((0.02, 0.06, tall / 2 + low), (-0.05, 0, (tall / 2 + low) / 2))),
        part("neck brushed", box((0.03, 0.06, 0.06), (-0.045, 0, low + tall / 2))),
        part("foot brushed", box((0.19, 0.25, 0.012), (-0.01, 0, 0.006))),
    ]


def keyboard(case: Vector3, keys: Vector3) -> list[RawPart]:
    """Return a keyboard, as wide as usual, with its keys; the space bar is in front."""
    wide, deep, pitch = 0.435, 0.130, 0.019
    look = {"base_colour": (*keys, 1.0), "roughness": 0.55}
    parts = [
        part("case plastic", box((deep, wide, 0.012), (0, 0, 0.006)), base_colour=(*case, 1.0)),
        part("foot rubber", box((0.012, wide - 0.06, 0.006), (-deep / 2 + 0.01, 0, 0.003))),
    ]
    rows: list[list[float]] = [
        [1.0] * 13,
        [1.0] * 13 + [2.0],
        [1.5] + [1.0] * 12 + [1.5],
        [1.75] + [1.0] * 11 + [2.25],
        [1.25] + [1.0] * 11 + [2.75],
        [1.25, 1.25, 1.25, 5.75, 1.25, 1.25, 1.25, 1.75],
    ]
    back = -deep / 2 + 0.017
    for row, sizes in enumerate(rows):
        x = back + row * pitch
        scale = 15.0 / sum(sizes)
        y = wide / 2 - 0.012
        for size in sizes:
            width = size * scale * pitch
            parts.append(part("keys plastic", _key(width - 0.003, (x, y - width / 2)), **look))
            y -= width
        for column in range(3 if row != 3 else 0):
            if row == 4 and column != 1:
                continue
            at = (x, wide / 2 - 0.012 - (15.4 + column) * pitch)
            parts.append(part("keys plastic", _key(pitch - 0.003, at), **look))
        for column in range(4):
            at = (x, wide / 2 - 0.012 - (18.6 + column) * 0.0182)
            parts.append(part("keys plastic", _key(0.0155, at), **look))
    return parts


def mouse(shell: Vector3) -> list[RawPart]:
    """Return a mouse with two keys and a wheel."""
    body = raw_mesh(sphere_mesh(1.0))
    points = body.positions * (0.055, 0.031, 0.036)
    points[:, 2] = np.maximum(points[:, 2], 0.0)
    points[:, 2] *= 1.0 - 0.22 * np.clip(points[:, 0] / 0.055, -1.0, 1.0)
    hull = RawMesh(positions=points, uvs=body.uvs, triangles=body.triangles)
    dark = {"base_colour": (0.03, 0.03, 0.03, 1.0)}
    wheel = raw_mesh(cylinder_mesh(0.009, 0.007))
    turned = wheel.positions[:, [0, 2, 1]] + (0.028, 0.0, 0.0235)
    return [
        part("shell plastic", hull, base_colour=(*shell, 1.0), roughness=0.4),
        part("split rubber", box((0.05, 0.001, 0.003), (0.027, 0, 0.0265)), **dark),
        part(
            "wheel rubber",
            RawMesh(positions=turned, uvs=wheel.uvs, triangles=wheel.triangles[:, ::-1]),
            **dark,
        ),
    ]


def computer() -> list[RawPart]:
    """Return a computer in a case that stands upright."""
    deep, wide, tall = 0.42, 0.19, 0.42
    front = deep / 2
    dark = {"base_colour": (0.02, 0.02, 0.022, 1.0), "roughness": 0.5}
    parts = [
        part(
            "case metal paint", box((deep - 0.02, wide, tall - 0.02), (-0.01, 0, tall / 2)), **dark
        ),
        part("front plastic", box((0.02, wide, tall - 0.02), (front - 0.01, 0, tall / 2)), **dark),
        part("drive", box((0.004, wide - 0.03, 0.042), (front, 0, tall - 0.06)), **_BLACK),
        part("key brushed", rod(0.011, 0.008, (front + 0.002, 0, tall - 0.13))),
        part(
            "lamp",
            box((0.003, 0.02, 0.004), (front, 0, tall - 0.16)),
            base_colour=(0.05, 0.3, 0.6, 1.0),
        ),
    ]
    for row in range(9):
        slit = box((0.004, wide - 0.06, 0.006), (front, 0, 0.06 + 0.016 * row))
        parts.append(part("slit", slit, **_BLACK))
    for x in (-0.15, 0.15):
        for y in (-0.07, 0.07):
            parts.append(part("foot rubber", box((0.03, 0.02, 0.012), (x, y, 0.006))))
    return parts


def whiteboard(wide: float, tall: float) -> list[RawPart]:
    """Return a whiteboard that hangs on the wall behind it, with a drawing, a tray and pens."""
    edge = 0.022
    bars = [
        box((0.024, wide, edge), (0.012, 0, edge / 2)),
        box((0.024, wide, edge), (0.012, 0, tall - edge / 2)),
        box((0.024, edge, tall - 2 * edge), (0.012, (wide - edge) / 2, tall / 2)),
        box((0.024, edge, tall - 2 * edge), (0.012, -(wide - edge) / 2, tall / 2)),
        box((0.06, wide * 0.5, 0.008), (0.05, 0, 0.012)),
        box((0.006, wide * 0.5, 0.02), (0.079, 0, 0.018)),
    ]
    parts = [part("frame alu", bar) for bar in bars]
    parts.append(
        part(
            "board",
            _face(wide - 2 * edge, tall - 2 * edge, (0.018, 0.0, tall / 2)),
            base_colour=(1, 1, 1, 1),
            base_colour_texture=_drawing(wide / tall),
            roughness=0.18,
        )
    )
    back = box((0.008, wide - edge, tall - edge), (0.004, 0, tall / 2))
    parts.append(part("back", back, base_colour=(0.4, 0.4, 0.4, 1.0)))
    colours = ((0.02, 0.05, 0.35), (0.4, 0.02, 0.02), (0.02, 0.2, 0.05))
    for index, ink in enumerate(colours):
        pen = rod(0.008, 0.13, (0.0, 0.0, 0.0))
        along = pen.positions[:, [1, 0, 2]] + (0.05, 0.16 * (index - 1), 0.0245)
        mesh = RawMesh(positions=along, uvs=pen.uvs, triangles=pen.triangles[:, ::-1])
        parts.append(part(f"pen {index} plastic", mesh, base_colour=(*ink, 1.0)))
    return parts


def _key(width: float, at: tuple[float, float]) -> RawMesh:
    """Return a key whose upper side is smaller than its foot."""
    mesh = box((0.016, width, 0.007), (0.0, 0.0, 0.0155))
    points = mesh.positions.copy()
    top = points[:, 2] > 0.0155
    points[top, :2] *= (0.8, 1.0 - 0.003 / width)
    return RawMesh(positions=points + np.array([*at, 0.0]), uvs=mesh.uvs, triangles=mesh.triangles)


def _disc(radius: float, height: float, centre: Vector3) -> RawMesh:
    raw = raw_mesh(cylinder_mesh(radius, height))
    return dataclasses.replace(raw, positions=raw.positions + np.asarray(centre))


def _face(wide: float, tall: float, centre: Vector3) -> RawMesh:
    """Return a rectangle that looks along x, whose picture is right for who stands before it."""
    x, y, z = centre
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return RawMesh(
        positions=np.array([[x, y + s * wide / 2, z + t * tall / 2] for s, t in corners]),
        uvs=np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
        triangles=np.array([[0, 1, 2], [0, 2, 3]]),
    )


def _texture(picture: NDArray[np.uint8]) -> Texture:
    pixels = np.full((*picture.shape[:2], 4), 255, np.uint8)
    pixels[..., :3] = picture
    pixels.flags.writeable = False
    return pixels


def desktop_picture(number: int, ratio: float) -> Texture:
    """Return what a screen shows: windows with lines of text, a chart."""
    generator = np.random.default_rng(700 + number)
    tall = 360
    wide = round(tall * ratio)
    down = np.linspace(0.0, 1.0, tall)[:, None, None]
    picture = np.zeros((tall, wide, 3)) + (28, 52, 84) + down * (30, 40, 46)
    image = np.ascontiguousarray(picture.astype(np.uint8))
    frames = [(0.05, 0.08, 0.56, 0.86), (0.60, 0.08, 0.95, 0.48), (0.60, 0.53, 0.95, 0.86)]
    for index, (left, top, right, low) in enumerate(frames):
        x0, y0, x1, y1 = (round(v) for v in (left * wide, top * tall, right * wide, low * tall))
        ground = (30, 32, 38) if index == 0 else (244, 244, 240)
        cv2.rectangle(image, (x0, y0), (x1, y1), ground, -1)
        cv2.rectangle(image, (x0, y0), (x1, y0 + 12), (70, 74, 82), -1)
        if index == 2:
            bars = generator.uniform(0.2, 0.9, 9)
            step = (x1 - x0 - 20) / 9
            for place, share in enumerate(bars):
                left_x = round(x0 + 10 + place * step)
                top_y = round(y1 - 8 - share * (y1 - y0 - 30))
                cv2.rectangle(
                    image,
                    (left_x, top_y),
                    (round(left_x + 0.65 * step), y1 - 8),
                    (66, 122, 178),
                    -1,
                )
            continue
        inks = (
            ((190, 200, 210), (120, 180, 130), (210, 160, 100)) if index == 0 else ((70, 70, 74),)
        )
        for y in range(y0 + 22, y1 - 6, 9):
            x = x0 + 10 + 12 * int(generator.integers(0, 3)) * (index == 0)
            while x < x1 - 40 and generator.random() > 0.12:
                length = int(generator.integers(8, 40))
                ink = inks[int(generator.integers(len(inks)))]
                cv2.rectangle(image, (x, y), (min(x + length, x1 - 8), y + 3), ink, -1)
                x += length + 6
    cv2.rectangle(image, (0, tall - 20), (wide, tall), (18, 22, 30), -1)
    for place in range(6):
        at = (16 + 26 * place, tall - 16)
        cv2.rectangle(
            image, at, (at[0] + 12, at[1] + 12), (90 + 20 * place, 140, 200 - 18 * place), -1
        )
    return _texture(image)


def _drawing(ratio: float) -> Texture:
    """Return what is written on a whiteboard: boxes with arrows, a curve, lists."""
    generator = np.random.default_rng(31)
    tall = 512
    wide = round(tall * ratio)
    image = np.full((tall, wide, 3), 243, np.uint8)
    inks = ((30, 50, 140), (160, 40, 36), (30, 110, 60), (40, 40, 44))
    smear = cv2.GaussianBlur(generator.uniform(-9, 4, (tall // 8, wide // 8)), (0, 0), 4)
    image = np.clip(image + cv2.resize(smear, (wide, tall))[..., None], 0, 255).astype(np.uint8)
    image = np.ascontiguousarray(image)
    boxes = [(0.06, 0.12), (0.06, 0.42), (0.30, 0.27), (0.30, 0.60)]
    for index, (x, y) in enumerate(boxes):
        x0, y0 = round(x * wide), round(y * tall)
        ink = inks[index % 2 * 3]
        cv2.rectangle(image, (x0, y0), (x0 + 120, y0 + 62), ink, 3, cv2.LINE_AA)
        for line in range(2):
            at = (x0 + 14, y0 + 22 + 18 * line)
            cv2.line(
                image, at, (at[0] + int(generator.integers(50, 90)), at[1]), ink, 2, cv2.LINE_AA
            )
    for start, end in (((0.06, 0.12), (0.30, 0.27)), ((0.06, 0.42), (0.30, 0.60))):
        a = (round(start[0] * wide) + 122, round(start[1] * tall) + 34)
        b = (round(end[0] * wide) - 4, round(end[1] * tall) + 28)
        cv2.arrowedLine(image, a, b, inks[1], 3, cv2.LINE_AA, tipLength=0.12)
    along = np.linspace(0.0, 1.0, 200)
    rise = 0.75 - 0.5 * (1.0 - np.exp(-4.0 * along)) + 0.03 * np.sin(14.0 * along)
    points = np.stack([0.58 * wide + 0.36 * wide * along, 0.12 * tall + 0.5 * tall * rise], axis=1)
    origin = (round(0.58 * wide), round(0.55 * tall))
    cv2.arrowedLine(
        image, origin, (round(0.96 * wide), origin[1]), inks[3], 3, cv2.LINE_AA, tipLength=0.04
    )
    cv2.arrowedLine(
        image, origin, (origin[0], round(0.10 * tall)), inks[3], 3, cv2.LINE_AA, tipLength=0.05
    )
    cv2.polylines(image, [points.round().astype(np.int32)], False, inks[0], 3, cv2.LINE_AA)
    for line in range(5):
        at = (round(0.60 * wide), round((0.66 + 0.065 * line) * tall))
        cv2.circle(image, at, 4, inks[2], -1, cv2.LINE_AA)
        words = at[0] + 18
        while words < 0.86 * wide and generator.random() > 0.15:
            length = int(generator.integers(20, 70))
            end = (words + length, at[1] + int(generator.integers(-2, 3)))
            cv2.line(image, (words, at[1]), end, inks[3], 2, cv2.LINE_AA)
            words += length + 14
    return _texture(image)
