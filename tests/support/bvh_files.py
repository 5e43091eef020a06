"""BVH files of a person of sticks, named in several ways, who moves as a test says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

__all__ = ["CMU", "DAZ", "KNEES", "bvh_text", "euler_deg"]

_BONES = (
    ("hips", "", (0.0, 0.0, 0.0)),
    ("left thigh", "hips", (0.1, -0.05, 0.0)),
    ("left shin", "left thigh", (0.0, -0.4, 0.0)),
    ("left foot", "left shin", (0.0, -0.42, 0.0)),
    ("left toe", "left foot", (0.0, -0.06, 0.14)),
    ("right thigh", "hips", (-0.1, -0.05, 0.0)),
    ("right shin", "right thigh", (0.0, -0.4, 0.0)),
    ("right foot", "right shin", (0.0, -0.42, 0.0)),
    ("right toe", "right foot", (0.0, -0.06, 0.14)),
    ("spine", "hips", (0.0, 0.15, 0.0)),
    ("chest", "spine", (0.0, 0.2, 0.0)),
    ("neck", "chest", (0.0, 0.2, 0.0)),
    ("head", "neck", (0.0, 0.1, 0.0)),
    ("left collar", "chest", (0.03, 0.15, 0.0)),
    ("left upper arm", "left collar", (0.15, 0.0, 0.0)),
    ("left forearm", "left upper arm", (0.28, 0.0, 0.0)),
    ("left hand", "left forearm", (0.25, 0.0, 0.0)),
    ("right collar", "chest", (-0.03, 0.15, 0.0)),
    ("right upper arm", "right collar", (-0.15, 0.0, 0.0)),
    ("right forearm", "right upper arm", (-0.28, 0.0, 0.0)),
    ("right hand", "right forearm", (-0.25, 0.0, 0.0)),
)
"""Arms spread, y up, looks along z."""


def _sided(names: Mapping[str, str], sides: tuple[str, str]) -> dict[str, str]:
    return {
        f"{side} {bone}": name.format(word)
        for side, word in zip(("left", "right"), sides, strict=True)
        for bone, name in names.items()
    }


CMU = {
    **{"hips": "Hips", "spine": "Spine", "chest": "Spine1", "neck": "Neck", "head": "Head"},
    **_sided(
        {"thigh": "{}UpLeg", "shin": "{}Leg", "foot": "{}Foot", "toe": "{}ToeBase",
         "collar": "{}Shoulder", "upper arm": "{}Arm", "forearm": "{}ForeArm", "hand": "{}Hand"},
        ("Left", "Right"),
    ),
}  # fmt: skip
DAZ = {
    **{"hips": "hip", "spine": "abdomen", "chest": "chest", "neck": "neck", "head": "head"},
    **_sided(
        {"thigh": "{}Thigh", "shin": "{}Shin", "foot": "{}Foot", "toe": "{}Toe",
         "collar": "{}Collar", "upper arm": "{}Shldr", "forearm": "{}ForeArm", "hand": "{}Hand"},
        ("l", "r"),
    ),
}  # fmt: skip
KNEES = {
    **{"hips": "Hips", "spine": "Chest", "chest": "Chest2", "neck": "Neck", "head": "Head"},
    **_sided(
        {"thigh": "{}Hip", "shin": "{}Knee", "foot": "{}Ankle", "toe": "{}Toe",
         "collar": "{}Collar", "upper arm": "{}Shoulder", "forearm": "{}Elbow", "hand": "{}Wrist"},
        ("Left", "Right"),
    ),
}  # fmt: skip


def bvh_text(
    frames: Sequence[Mapping[str, np.ndarray]],
    *,
    names: Mapping[str, str] = CMU,
    order: str = "ZYX",
    unit: float = 1.0,
    frame_s: float = 1.0 / 60.0,
) -> str:
    """The text of a file.

    Parameters
    ----------
    frames : sequence of mapping of str to array
        Rotations (3, 3) of bones, and the place (3,) of the hips, called 'place'.
    """
    lines = ["HIERARCHY"]

    def write(bone: str, offset: tuple[float, float, float], depth: int) -> None:
        pad = "\t" * depth
        lines.append(f"{pad}{'JOINT' if depth else 'ROOT'} {names[bone]}")
        lines.append(f"{pad}{{")
        lines.append(f"{pad}\tOFFSET " + " ".join(f"{unit * v:.6f}" for v in offset))
        turns = " ".join(f"{axis}rotation" for axis in order)
        places = "" if depth else "Xposition Yposition Zposition "
        lines.append(f"{pad}\tCHANNELS {3 if depth else 6} {places}{turns}")
        below = [(name, place) for name, parent, place in _BONES if parent == bone]
        for name, place in below:
            write(name, place, depth + 1)
        if not below:
            lines.extend([f"{pad}\tEnd Site", f"{pad}\t{{"])
            lines.append(f"{pad}\t\tOFFSET 0.0 {0.1 * unit} 0.0")
            lines.append(f"{pad}\t}}")
        lines.append(f"{pad}}}")

    write("hips", (0.0, 0.0, 0.0), 0)
    lines += ["MOTION", f"Frames: {len(frames)}", f"Frame Time: {frame_s:.7f}"]
    for frame in frames:
        place = unit * np.asarray(frame.get("place", (0.0, 0.93, 0.0)))
        numbers = place.tolist()
        for bone in _written_order():
            numbers.extend(euler_deg(frame.get(bone, np.eye(3)), order))
        lines.append(" ".join(f"{value:.6f}" for value in numbers))
    return "\n".join(lines) + "\n"


def _written_order() -> list[str]:
    found: list[str] = []

    def visit(bone: str) -> None:
        found.append(bone)
        for name, parent, _ in _BONES:
            if parent == bone:
                visit(name)

    visit("hips")
    return found


def euler_deg(turn: np.ndarray, order: str) -> list[float]:
    """Angles about three different axes whose rotations, in that order, are a rotation [deg]."""
    first, second, third = ("XYZ".index(axis) for axis in order)
    sign = 1.0 if (second - first) % 3 == 1 else -1.0
    middle = np.arcsin(np.clip(sign * turn[first, third], -1.0, 1.0))
    one = np.arctan2(-sign * turn[second, third], turn[third, third])
    last = np.arctan2(-sign * turn[first, second], turn[first, first])
    return [float(np.degrees(angle)) for angle in (one, middle, last)]
