"""Motion files of DeepMimic, which `pybullet_data` has → `MotionClip`s.

A frame is its duration, the place and the turn of the root, and the turns of the joints of one
humanoid: quaternions w, x, y, z, and angles of knees and elbows. See X. B. Peng et al., *DeepMimic:
Example-Guided Deep Reinforcement Learning of Physics-Based Character Skills*, SIGGRAPH 2018.
"""

from __future__ import annotations

import json

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.motions.bvh import MOST_FRAMES
from sailenv_ros.errors import AssetError
from sailenv_ros.types.instance_states import rotation_matrices
from sailenv_ros.types.motion_clip import MotionClip

__all__ = ["read_deep_mimic"]

Doubles = NDArray[np.float64]

_JOINTS = (
    ("root", "", (0.0, 0.0, 0.0), 4),
    ("chest", "root", (0.0, 0.236151, 0.0), 4),
    ("neck", "chest", (0.0, 0.223894, 0.0), 4),
    ("head", "neck", (0.0, 0.12, 0.0), 0),
    ("right_hip", "root", (0.0, 0.0, 0.084887), 4),
    ("right_knee", "right_hip", (0.0, -0.421546, 0.0), 1),
    ("right_ankle", "right_knee", (0.0, -0.40987, 0.0), 4),
    ("right_toe", "right_ankle", (0.12, -0.055, 0.0), 0),
    ("right_shoulder", "chest", (-0.02405, 0.24350, 0.18311), 4),
    ("right_elbow", "right_shoulder", (0.0, -0.274788, 0.0), 1),
    ("right_wrist", "right_elbow", (0.0, -0.258947, 0.0), 0),
    ("left_hip", "root", (0.0, 0.0, -0.084887), 4),
    ("left_knee", "left_hip", (0.0, -0.421546, 0.0), 1),
    ("left_ankle", "left_knee", (0.0, -0.40987, 0.0), 4),
    ("left_toe", "left_ankle", (0.12, -0.055, 0.0), 0),
    ("left_shoulder", "chest", (-0.02405, 0.24350, -0.18311), 4),
    ("left_elbow", "left_shoulder", (0.0, -0.274788, 0.0), 1),
    ("left_wrist", "left_elbow", (0.0, -0.258947, 0.0), 0),
)
"""Name, parent, offset [m], and the count of numbers that a frame has of its turn."""

_WIDTH = 4 + sum(count for *_, count in _JOINTS)


def read_deep_mimic(name: str, data: bytes) -> MotionClip:
    """Return the motion of a file of DeepMimic's humanoid.

    Raises
    ------
    AssetError
        If it is malformed, or of another creature.
    """
    try:
        frames = json.loads(data)["Frames"]
        values = np.array(frames, np.float64)
    except (ValueError, TypeError, KeyError, RecursionError, UnicodeDecodeError):
        raise AssetError(
            name, "it is no motion file: a list 'Frames' of numbers is needed"
        ) from None
    if values.ndim != 2 or values.shape[1] != _WIDTH or not 1 < len(values) <= MOST_FRAMES:
        accepted = (
            f"2 to {MOST_FRAMES} frames of {_WIDTH} numbers, those of a humanoid, are accepted"
        )
        raise AssetError(name, f"its frames are {values.shape} numbers: {accepted}")
    step = float(np.median(values[:-1, 0]))
    if not np.isfinite(values).all() or not 0.0 < step <= 1.0:
        raise AssetError(
            name, "a number is not finite, or a frame not above 0 and at most 1 s long"
        )
    names = tuple(joint for joint, *_ in _JOINTS)
    turns = np.broadcast_to(np.eye(3), (len(values), len(names), 3, 3)).copy()
    column = 4
    for number, (*_, count) in enumerate(_JOINTS):
        part = values[:, column : column + count]
        column += count
        if count == 1:
            part = _about_z(part[:, 0])
        if count:
            length = np.linalg.norm(part, axis=1, keepdims=True)
            if not (length > 1e-3).all():
                raise AssetError(name, "a turn is no quaternion: its numbers are all 0")
            turns[:, number] = rotation_matrices(np.roll(part / length, -1, axis=1))
    return MotionClip(
        name=name,
        joint_names=names,
        parents=np.array([names.index(p) if p else -1 for _, p, *_ in _JOINTS], np.int64),
        offsets=np.array([offset for _, _, offset, _ in _JOINTS]),
        turns=turns,
        roots=values[:, 1:4].copy(),
        frame_s=step,
    )


def _about_z(angles: Doubles) -> Doubles:
    """Return (F, 4) w, x, y, z of rotations about z [rad]."""
    half, zero = 0.5 * angles, np.zeros_like(angles)
    return np.stack([np.cos(half), zero, zero, np.sin(half)], axis=1)
