"""Joints of URDF and MJCF files → joints of scene files.

What MuJoCo read in, entries out. Positions are MuJoCo's less its reference: at 0 a link is where
the file's own poses put it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.safe_xml import XmlNode
from sailenv_ros.errors import AssetError
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import is_finite_number

__all__ = ["FREE", "RobotJoint", "check_limits", "moving_joint", "pose_entry", "pose_of_body"]

Doubles = NDArray[np.float64]

FREE, _BALL, _SLIDE, _HINGE = 0, 1, 2, 3
"""MuJoCo's numbers of kinds of joints, which its files fix."""

LEAST_FRICTION = {"hinge": 0.5, "slide": 1.0}
"""Friction of joints whose file does not specify it [N m], [N]."""

HOLDS = 1.2
"""Friction of such joints, as a multiple of what holds their weight."""

LEAST_EFFORT = 100.0
GRAVITY_M_S2 = 9.81
POSITION_DECIMALS, ANGLE_DECIMALS = 9, 8


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotJoint:
    """A joint that moves, or why one does not.

    Attributes
    ----------
    entry : dict or None
        Its keys in a scene file, but for the parent; None if it is fixed.
    why_fixed : str
        Empty if it moves.
    guessed_friction : bool
        True if the file says nothing of it.
    """

    entry: dict[str, Any] | None
    why_fixed: str = ""
    guessed_friction: bool = False


def check_limits(root: XmlNode, file: str) -> dict[str, tuple[float, float]]:
    """Return the limits of a URDF's joints by their names, as MuJoCo takes some of them for none.

    Raises
    ------
    AssetError
        If limits are missing, no numbers, or in the wrong order.
    """
    limits: dict[str, tuple[float, float]] = {}
    if root.tag != "robot":
        return limits
    for joint in root.all("joint"):
        kind, name = joint.text("type"), joint.text("name")
        if kind not in ("revolute", "prismatic"):
            continue
        node = joint.first("limit")
        if node is None:
            raise AssetError(file, f"joint {name[:80]!r} is {kind} and has no <limit>")
        low, high = (_number(node.text(key, "0")) for key in ("lower", "upper"))
        if low is None or high is None or low > high:
            shown = f"lower={node.text('lower', '0')[:20]!r} upper={node.text('upper', '0')[:20]!r}"
            accepted = "two numbers, the lower one first"
            raise AssetError(file, f"limits of joint {name[:80]!r} must be {accepted}, got {shown}")
        limits[name] = (low, high)
    return limits


def moving_joint(
    joints: Sequence[Mapping[str, Any]], limits: Mapping[str, tuple[float, float]], file: str
) -> RobotJoint:
    """Return the joint of a body as a scene file has it.

    Parameters
    ----------
    joints : sequence of mapping
        Those of the body, as `robot_reader` tells of them; at least one.
    limits : mapping
        What `check_limits` returned.
    file : str
        For errors.

    Raises
    ------
    AssetError
        If its limits are malformed.
    """
    joint = joints[0]
    if len(joints) > 1:
        return RobotJoint(entry=None, why_fixed="a body with several joints")
    if joint["type"] not in (_SLIDE, _HINGE):
        return RobotJoint(entry=None, why_fixed="a ball joint")
    bounds = _bounds(joint, limits, file)
    if bounds is not None and bounds[0] == bounds[1]:
        return RobotJoint(entry=None, why_fixed="limits without a way between them")
    kind = "slide" if joint["type"] == _SLIDE else "hinge"
    entry: dict[str, Any] = {"type": kind, "axis": [round(v, 9) + 0.0 for v in joint["axis"]]}
    if kind == "hinge" and any(joint["origin"]):
        entry["origin"] = [round(v, POSITION_DECIMALS) + 0.0 for v in joint["origin"]]
    if bounds is not None:
        entry["limits"] = [round(v, 9) + 0.0 for v in bounds]
    low, high = entry.get("limits", (-1e4, 1e4))
    start = min(max(round(joint["start"], 9), low), high) + 0.0
    if start != min(max(0.0, low), high):
        entry["position"] = start
    if joint["damping"] > 0.0:
        entry["damping"] = round(min(joint["damping"], 1e6), 6)
    friction, guessed = joint["friction"], joint["friction"] <= 0.0
    if guessed:
        friction = HOLDS * joint["weight"] + LEAST_FRICTION[kind]
    entry["friction"] = round(min(friction, 1e6), 6)
    effort = max(LEAST_EFFORT, joint["effort"], 2.0 * friction + joint["weight"])
    if effort > LEAST_EFFORT:
        entry["effort"] = round(min(effort, 1e6), 3)
    return RobotJoint(entry=entry, guessed_friction=guessed)


def _bounds(
    joint: Mapping[str, Any], limits: Mapping[str, tuple[float, float]], file: str
) -> tuple[float, float] | None:
    if joint["name"] in limits:
        return limits[joint["name"]]
    first, last = joint["range"]
    # MuJoCo takes a range in the wrong order for none.
    if not joint["limited"] and first <= last:
        return None
    low, high = first - joint["reference"], last - joint["reference"]
    if not (math.isfinite(low) and math.isfinite(high)) or low > high or max(-low, high) > 1e4:
        shown = f"[{low:.6g}, {high:.6g}]"
        accepted = "two numbers, the lower one first"
        name = joint["name"][:80]
        raise AssetError(file, f"limits of joint {name!r} must be {accepted}, got {shown}")
    return low, high


def pose_of_body(body: Mapping[str, Any]) -> Pose:
    """Return where a body is in the world as its file begins."""
    return _pose(body["position"], body["quat_wxyz"])


def pose_entry(pose: Pose) -> dict[str, Any]:
    """Return position and rotation, to a nanometre."""
    entry: dict[str, Any] = {
        "position": [round(v, POSITION_DECIMALS) + 0.0 for v in pose.position_m]
    }
    rpy = [round(v, ANGLE_DECIMALS) + 0.0 for v in pose.rpy_deg]
    if any(rpy):
        entry["rotation"] = rpy
    return entry


def _pose(position: Sequence[float], quat_wxyz: Sequence[float]) -> Pose:
    w, x, y, z = quat_wxyz
    norm = math.sqrt(w * w + x * x + y * y + z * z)
    px, py, pz = position
    return Pose((px, py, pz), (x / norm, y / norm, z / norm, w / norm))


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if is_finite_number(value) and abs(value) <= 1e4 else None
