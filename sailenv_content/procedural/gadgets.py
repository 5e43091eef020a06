"""Electric things of desks and living rooms: headphones, cables, a controller, a loudspeaker."""

from __future__ import annotations

import numpy as np

from sailenv_content.procedural import forms
from sailenv_content.procedural.devices import SCREEN_BLACK, SCREEN_WHITE
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import box, painted_part, part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart

__all__ = ["cable", "game_controller", "headphones", "power_strip", "speaker", "tablet"]


def headphones() -> list[RawPart]:
    """Return headphones that lie on their cushions."""
    turn = np.linspace(-0.08, np.pi + 0.08, 33)
    arc = np.stack([0.082 * np.sin(turn) + 0.028, 0.080 * np.cos(turn), np.full(33, 0.028)], -1)
    band = forms.tube(arc, 0.0085, sides=12)
    flat = band.positions * [1.0, 1.0, 1.35]
    band = RawMesh(positions=flat, uvs=band.uvs, triangles=band.triangles)
    parts = [painted_part("band rubber", band, "#1b1c1f")]
    for side in (1.0, -1.0):
        cup = forms.moved(
            forms.lathe(
                [
                    (0.0, 0.0),
                    (0.030, 0.0),
                    (0.035, 0.004),
                    (0.036, 0.015),
                    (0.028, 0.022),
                    (0, 0.024),
                ],
                36,
            ),
            turn_deg=(-90.0 * side, 0.0, 0.0),
        )
        cup = forms.moved(cup, (0.0, side * 0.070, 0.037))
        parts.append(painted_part("shell plastic", cup, "#2d2f34"))
        ring = np.concatenate([0.0255 * forms.circle(36), np.zeros((36, 1))], axis=1)
        pad = forms.moved(
            forms.tube(ring, 0.0105, sides=12, closed=True), turn_deg=(90.0, 0.0, 0.0)
        )
        pad = forms.moved(pad, (0.0, side * 0.063, 0.037))
        parts.append(painted_part("pad hide", pad, "#121212", roughness=0.7))
        cap = forms.moved(forms.lathe([(0.0, 0.0), (0.017, 0.0), (0.016, 0.002), (0.0, 0.002)], 32))
        cap = forms.moved(
            forms.moved(cap, turn_deg=(-90.0 * side, 0.0, 0.0)), (0.0, side * 0.0935, 0.037)
        )
        parts.append(painted_part("badge metal", cap, "#b0b2b5"))
    return forms.standing(parts)


def cable(colour: str = "#e9e9e7") -> list[RawPart]:
    """Return a coiled charging cable with a plug at each end."""
    turn = np.linspace(0.0, 3.6 * 2.0 * np.pi, 150)
    radius = 0.042 + 0.005 * np.sin(1.7 * turn) + 0.003 * np.cos(0.6 * turn)
    rise = 0.0022 + 0.0016 * turn / (2.0 * np.pi) + 0.0006 * np.sin(3.1 * turn)
    coil = np.stack([1.15 * radius * np.cos(turn), radius * np.sin(turn), rise], axis=-1)
    end = coil[-1]
    tail = forms.curve(
        [coil[-2], end, np.add(end, (-0.012, 0.03, -0.003)), (-0.085, 0.052, 0.0022)], 20
    )
    start = coil[0]
    head = forms.curve([(0.105, -0.045, 0.0022), (0.075, -0.030, 0.0022), start, coil[1]], 20)
    path = np.concatenate([head[:-2], coil, tail[3:]])
    parts = [painted_part("cord rubber", forms.tube(path, 0.0018, sides=8), colour)]
    for place, ahead in ((path[0], path[0] - path[3]), (path[-1], path[-1] - path[-4])):
        angle = float(np.degrees(np.arctan2(ahead[1], ahead[0])))
        shell = forms.moved(
            forms.slab(forms.rectangle(0.011, 0.024, 0.002), 0.0056, 0.0015), (0.010, 0.0, -0.0006)
        )
        tip = box((0.011, 0.0082, 0.0030), (0.0270, 0.0, 0.0022))
        for name, mesh, shade in (("shell plastic", shell, colour), ("tip metal", tip, "#bfbfc1")):
            placed = forms.moved(forms.moved(mesh, turn_deg=(0.0, 0.0, angle)), (*place[:2], 0.0))
            parts.append(painted_part(name, placed, shade))
    return forms.standing(parts)


def power_strip() -> list[RawPart]:
    """Return a strip of three sockets with its cord."""
    body = forms.slab(forms.rectangle(0.052, 0.240, 0.014), 0.034, 0.006)
    parts = [painted_part("body plastic", body, "#ecebe6")]
    for x in (-0.062, 0.0, 0.062):
        dish = forms.lathe(
            [(0.0215, 0.0338), (0.0215, 0.0352), (0.0190, 0.0352), (0.0185, 0.0345), (0, 0.0343)]
        )
        parts.append(painted_part("rim plastic", forms.moved(dish, (x, 0.0, 0.0)), "#d8d7d2"))
        for y in (-0.0095, 0.0095):
            hole = forms.lathe([(0.0, 0.0344), (0.0026, 0.0347), (0.0, 0.0348)], 12)
            parts.append(painted_part("hole", forms.moved(hole, (x, y, 0.0)), "#1a1a1a"))
    switch = forms.moved(
        forms.slab(forms.rectangle(0.020, 0.014, 0.003), 0.004, 0.0015), (0.104, 0.0, 0.0335)
    )
    parts.append(painted_part("switch plastic", switch, "#b3271e"))
    cord = forms.curve(
        [
            (-0.115, 0, 0.017),
            (-0.150, 0, 0.010),
            (-0.19, 0.05, 0.004),
            (-0.12, 0.11, 0.004),
            (-0.02, 0.095, 0.004),
            (0.05, 0.13, 0.004),
        ],
        60,
    )
    parts.append(painted_part("cord rubber", forms.tube(cord, 0.0038, sides=10), "#e2e1dc"))
    return forms.standing(parts)


def game_controller() -> list[RawPart]:
    """Return a game controller that lies on its back."""
    turn = np.linspace(0.0, 2.0 * np.pi, 72, endpoint=False)
    y = 0.076 * np.cos(turn)
    front = 0.040 * np.sin(turn)
    grips = np.exp(-(((np.abs(y) - 0.056) / 0.017) ** 2)) * (front > 0.0)
    x = front * np.where(front > 0.0, 0.62, 0.95) + 0.062 * grips * np.sin(turn).clip(0.0)
    # From low to high, narrowest at the ends.
    levels = (
        (0.55, 0.000),
        (0.86, 0.005),
        (1.0, 0.015),
        (0.98, 0.024),
        (0.88, 0.032),
        (0.70, 0.036),
    )
    rings = np.stack(
        [np.stack([size * x, -size * y, np.full(len(x), z)], -1) for size, z in levels]
    )
    parts = [painted_part("shell plastic", forms.loft(rings[:, ::-1]), "#22252b")]
    for sy, sx in ((0.026, 0.012), (-0.026, 0.012)):
        stick = forms.lathe(
            [(0.0075, 0.030), (0.0065, 0.041), (0.0100, 0.043), (0.0098, 0.046), (0, 0.045)], 24
        )
        parts.append(painted_part("stick rubber", forms.moved(stick, (sx, sy, 0.0)), "#0f1012"))
    for angle, colour in ((0, "#3f74c4"), (90, "#c9484e"), (180, "#4da263"), (270, "#d2a33c")):
        bx, by = 0.0105 * np.cos(np.radians(angle)), 0.0105 * np.sin(np.radians(angle))
        button = forms.lathe(
            [(0.0046, 0.032), (0.0046, 0.0385), (0.0038, 0.0395), (0.0, 0.0398)], 20
        )
        parts.append(
            painted_part("button", forms.moved(button, (bx - 0.011, by + 0.046, 0)), colour)
        )
    for size in ((0.022, 0.0075, 0.006), (0.0075, 0.022, 0.006)):
        parts.append(painted_part("cross plastic", box(size, (-0.011, -0.046, 0.036)), "#101114"))
    return forms.standing(parts)


def speaker() -> list[RawPart]:
    """Return a loudspeaker for a desk."""
    cabinet = forms.moved(forms.slab(forms.rectangle(0.115, 0.125, 0.006), 0.190, 0.004))
    parts = [painted_part("cabinet wood", cabinet, "#5a3a22", roughness=0.4)]
    front = forms.moved(
        forms.slab(forms.rectangle(0.107, 0.182, 0.004), 0.003, 0.001),
        (0.0615, 0, 0.095),
        (0, 90, 0),
    )
    parts.append(painted_part("baffle", front, "#1a1a1b", roughness=0.7))
    for z, size in ((0.068, 0.042), (0.147, 0.021)):
        cone = forms.lathe(
            [
                (1.12 * size, 0.0),
                (1.12 * size, 0.004),
                (1.0 * size, 0.005),
                (0.88 * size, 0.0038),
                (0.80 * size, 0.0042),
                (0.34 * size, -0.006),
                (0.30 * size, -0.004),
                (0, 0.0),
            ],
            40,
        )
        cone = forms.moved(cone, (0.0645, 0.0, z), (0.0, 90.0, 0.0))
        parts.append(
            painted_part("cone", cone, "#3b3d40" if size > 0.03 else "#83868a", roughness=0.5)
        )
    return forms.standing(parts)


def tablet() -> list[RawPart]:
    """Return a tablet computer that lies with its screen up."""
    screen = Sheet(512, 360, (0.1, 0.1, 0.1)).shade((0.16, 0.30, 0.48), (0.55, 0.42, 0.50))
    for row in range(3):
        for column in range(6):
            colour = [(0.9, 0.55, 0.3), (0.3, 0.65, 0.5), (0.85, 0.85, 0.88), (0.45, 0.5, 0.85)]
            x, y = 0.12 + 0.152 * column, 0.20 + 0.24 * row
            screen.box(x - 0.04, y - 0.057, x + 0.04, y + 0.057, colour[(row * 5 + column * 3) % 4])
    return forms.standing(
        [
            painted_part(
                "body alu",
                forms.slab(forms.rectangle(0.250, 0.174, 0.010), 0.0066, 0.0028),
                "#9fa2a6",
            ),
            painted_part(
                "bezel",
                forms.moved(
                    forms.slab(forms.rectangle(0.246, 0.170, 0.009), 0.0006), (0, 0, 0.0064)
                ),
                "#08080a",
                roughness=0.08,
            ),
            part(
                "display",
                forms.panel(0.154, 0.230, 0.0073),
                base_colour_texture=screen.texture(),
                base_colour=(*SCREEN_BLACK, 1.0),
                roughness=0.08,
                emission=SCREEN_WHITE,
            ),
        ]
    )
