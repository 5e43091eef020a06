"""Scenes in which flow is evaluated: boxes in a closed box, so that arithmetic knows every pixel.

Names of scenarios in, objects as in a scene file out, and the one textured model they need.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.pictures.codecs import encode_png

__all__ = ["BASE_SCENE", "SCENARIOS", "TEXTURED", "Scenario", "texture", "textured_cube_zip"]

TEXTURED = "textured_cube"
"""Catalogue name of the uploaded model: a cube of 1 m that stands on its origin."""

TRACK = [
    {"position": [-1.75, -0.7, 1.35], "rotation": [0, 2, 16]},
    {"position": [-1.55, 0.5, 1.6], "rotation": [0, 6, -12]},
    {"position": [-1.75, -0.7, 1.35], "rotation": [0, 2, 16]},
]

BASE_SCENE: Mapping[str, Any] = {
    "version": 1,
    "title": "Flow",
    "lights": [
        {"name": "sun", "type": "directional", "direction": [0.6, 0.35, -0.8], "intensity": 2.0}
    ],
    "mover": {"waypoints": TRACK, "total_time": 4.0, "loop": True},
}
"""A scene with light and a camera on rails, and nothing to see."""

WALLS = {
    "floor": ([0, 0, -0.1], [4.4, 4.4, 0.2], "#9a8b79"),
    "ceiling": ([0, 0, 3.1], [4.4, 4.4, 0.2], "#d8d4cc"),
    "north": ([0, 2.1, 1.5], [4.4, 0.2, 3], "#b8c0c8"),
    "south": ([0, -2.1, 1.5], [4.4, 0.2, 3], "#c8bfae"),
    "east": ([2.1, 0, 1.5], [0.2, 4, 3], "#aab4a4"),
    "west": ([-2.1, 0, 1.5], [0.2, 4, 3], "#b4b4b4"),
}

_STOPS = [
    {"position": [0.0, -0.5, 1.5]},
    {"position": [0.3, 0.5, 1.6], "rotation": [0, 20, 60]},
    {"position": [-0.2, 0.2, 1.3], "rotation": [40, 0, 100]},
]
SPIN: Mapping[str, Any] = {"type": "rotate_rigidbody", "angular_velocity": [12, 8, 40]}
BEHAVIOURS: tuple[Mapping[str, Any], ...] = (
    {"type": "rotate_rigidbody", "angular_velocity": [20, 0, 70]},
    {"type": "poltergeist", "mean_interval": 0.1, "acceleration": 12.0},
    {
        "type": "wander_plane",
        "waypoints": [[0, -1, 1.5], [0, 1, 1.6], [0.5, 0, 1.2]],
        "turn_rate": 60,
    },
    {"type": "uniform_movement_random_bounce", "speed": 0.8, "angular_speed": 45.0},
    {"type": "linear_waypoints", "waypoints": _STOPS, "total_time": 4.0},
    {"type": "catmull_waypoints", "waypoints": _STOPS, "total_time": 4.0},
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """One motion to judge flow by.

    Attributes
    ----------
    name : str
        A word, for files.
    label : str
        For people.
    textured : bool
        False paints everything in one colour each, as in the paper's scene.
    camera_moves : bool
    behaviours : tuple of mapping
        One object for each, moved by it; none means one that stands.
    """

    name: str
    label: str
    textured: bool = True
    camera_moves: bool = False
    behaviours: tuple[Mapping[str, Any], ...] = ()

    def objects(self) -> list[dict[str, Any]]:
        """Return the objects as a scene file has them."""
        entries = [
            {**self._box(name, place, scale, colour), "static": True}
            for name, (place, scale, colour) in WALLS.items()
        ]
        moving = self.behaviours or ({},)
        for number, behaviour in enumerate(moving):
            y = 0.0 if len(moving) == 1 else 1.3 * number - 0.65
            scale = [0.8, 0.8, 0.8] if len(moving) == 1 else [0.6, 0.45, 0.5]
            box = self._box(f"box {number}", [0.3, y, 1.4], scale, "#d1352b")
            box |= {"gravity": False, "rotation": [0, 0, 30]}
            entries.append({**box, "behaviours": [dict(behaviour)] if behaviour else []})
        return entries

    def _box(
        self, name: str, middle: list[float], scale: list[float], colour: str
    ) -> dict[str, Any]:
        if not self.textured:
            return {
                "name": name, "asset": "cube", "position": middle, "scale": scale, "colour": colour
            }  # fmt: skip
        place = [middle[0], middle[1], middle[2] - 0.5 * scale[2]]
        return {"name": name, "asset": TEXTURED, "position": place, "scale": scale}


SCENARIOS: Mapping[str, Scenario] = {
    scenario.name: scenario
    for scenario in (
        Scenario(name="uniform", label="rotating uniform cube", textured=False, behaviours=(SPIN,)),
        Scenario(name="textured", label="rotating textured cube", behaviours=(SPIN,)),
        Scenario(name="camera", label="camera motion", camera_moves=True),
        Scenario(name="both", label="camera and cube", camera_moves=True, behaviours=(SPIN,)),
        *(
            Scenario(name=motion["type"], label=motion["type"], behaviours=(motion, motion))
            for motion in BEHAVIOURS
        ),
    )
}
"""Every scenario by name."""


def texture(size_px: int = 512, seed: int = 7) -> NDArray[np.uint8]:
    """Make (size, size, 3) uint8 BGR: noise with detail at every scale, and a little colour."""
    random = np.random.default_rng(seed)
    total = np.zeros((size_px, size_px, 3), np.float32)
    for octave in range(2, 8):
        cells = random.random((2**octave, 2**octave, 3)).astype(np.float32)
        grown = cv2.resize(cells, (size_px, size_px), interpolation=cv2.INTER_CUBIC)
        total += (grown - 0.5) * 0.75**octave
    total += 2.0 * total.mean(axis=-1, keepdims=True)
    low, high = np.percentile(total, (1, 99))
    return np.asarray(np.clip(25 + 205 * (total - low) / (high - low), 0, 255), np.uint8)


def textured_cube_zip() -> bytes:
    """Return a zip of a Wavefront cube with its texture, as `Simulation.upload_model` takes it."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("cube.obj", _cube_obj())
        archive.writestr("cube.mtl", "newmtl skin\nKd 1 1 1\nNs 8\nmap_Kd skin.png\n")
        archive.writestr("skin.png", encode_png(texture()[..., ::-1]))
    return file.getvalue()


def _cube_obj() -> str:
    """Write a cube of 1 m that stands on the origin, y up as Wavefront files have it."""
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (0.0, 1.0) for z in (-0.5, 0.5)]
    lines = ["mtllib cube.mtl", *(f"v {x} {y} {z}" for x, y, z in corners)]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "usemtl skin"]
    faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    for face in faces:
        lines.append("f " + " ".join(f"{v}/{n}" for n, v in enumerate(face, start=1)))
    return "\n".join(lines) + "\n"
