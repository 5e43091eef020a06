"""Poses and carriers of the bodies of URDF and MJCF files: in the world, or on a joint.

Bodies as `robot_reader` tells of them in, entries of a scene file out. Bodies come in the order of
the file: what carries others before these.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_content.scene_import.imported import Entry
from sailenv_content.scene_import.robot_joints import (
    FREE,
    moving_joint,
    pose_entry,
    pose_of_body,
)
from sailenv_ros.types.geometry import Pose, invert

__all__ = ["RobotPlaces"]

Doubles = NDArray[np.float64]


class RobotPlaces:
    """The places of a file's bodies.

    Parameters
    ----------
    bodies : sequence of mapping
        All of them; the first one is the world.
    limits : mapping
        What `robot_joints.check_limits` returned.
    file : str
        For errors.
    """

    def __init__(
        self,
        bodies: Sequence[Mapping[str, Any]],
        limits: Mapping[str, tuple[float, float]],
        file: str,
    ) -> None:
        self._bodies = bodies
        self._limits = limits
        self._file = file
        self._objects: dict[int, str] = {}
        self._moving: set[int] = set()
        self._fixed: list[tuple[str, str]] = []
        self._guessed: list[str] = []

    def place(self, number: int) -> Entry:
        """Return the keys that say where a body is, and on what."""
        body = self._bodies[number]
        if self._is_loose(number):
            mass = {"mass": round(min(body["mass"], 1e6), 6)} if body["mass"] > 0.0 else {}
            return {**pose_entry(pose_of_body(body)), **(mass or {"static": True})}
        joint = None
        joints = [one for one in body["joints"] if one["type"] != FREE]
        if joints:
            found = moving_joint(joints, self._limits, self._file)
            joint = found.entry
            if joint is None:
                self._fixed += [(one["name"] or "unnamed", found.why_fixed) for one in joints]
            elif found.guessed_friction:
                self._guessed.append(joints[0]["name"] or "unnamed")
        elif body["joints"]:
            self._fixed.append((_name_of(body), "a free body that carries others"))
        parent, above = self._carrier(number)
        if joint is not None:
            self._moving.add(number)
            rest = np.array(body["rest_position"]), body["rest_quat_wxyz"]
            in_parent = pose_of_body({"position": rest[0], "quat_wxyz": rest[1]}).matrix()
            carrier = pose_of_body(self._bodies[body["parent"]]).matrix()
            pose = Pose.from_matrix(invert(above) @ carrier @ in_parent)
        elif self._goes_along(number):
            self._moving.add(number)
            joint = {"type": "fixed"}
            pose = Pose.from_matrix(invert(above) @ pose_of_body(body).matrix())
        else:
            return {**pose_entry(pose_of_body(body)), "static": True}
        mass = {"mass": round(min(max(body["mass"], 1e-3), 1e6), 6)}
        named = {"parent": parent} if parent else {}
        first = {"type": joint.pop("type")}
        return {**pose_entry(pose), **mass, "joint": {**first, **named, **joint}}

    def _carrier(self, number: int) -> tuple[str, Doubles]:
        """Return the nearest object that carries a body, and its pose as the file begins."""
        bodies = self._bodies
        above = bodies[number]["parent"]
        while above and above not in self._objects:
            above = bodies[above]["parent"]
        if not above:
            return "", np.eye(4)
        return self._objects[above], pose_of_body(bodies[above]).matrix()

    def _goes_along(self, number: int) -> bool:
        """Return whether something that carries a body moves on a joint."""
        bodies = self._bodies
        above = bodies[number]["parent"]
        while above:
            if above in self._moving and above in self._objects:
                return True
            above = bodies[above]["parent"]
        return False

    def _is_loose(self, number: int) -> bool:
        """Return whether a body moves freely: it alone, or with nothing on joints below it."""
        bodies = self._bodies
        free = any(joint["type"] == FREE for joint in bodies[number]["joints"])
        return free and not any(body["parent"] == number for body in bodies[1:])

    def take_note(self, number: int, name: str) -> None:
        """Take note that a body has become an object of that name."""
        self._objects[number] = name

    def leave_out(self, number: int) -> None:
        """Take note that a body on a joint has become no object."""
        self._fixed.append((_name_of(self._bodies[number]), "a body without a geometry"))

    def notes(self) -> Iterator[str]:
        """Yield which joints are fixed and why, and which got another friction than the file's."""
        whys: dict[str, list[str]] = {}
        for name, why in self._fixed:
            whys.setdefault(why, []).append(name)
        for why, names in whys.items():
            verb = "joint is" if len(names) == 1 else "joints are"
            yield f"{len(names)} {verb} fixed where the file begins ({why}): {_listed(names)}"
        if self._guessed:
            many = "1 joint has" if len(self._guessed) == 1 else f"{len(self._guessed)} joints have"
            get = "gets" if len(self._guessed) == 1 else "get"
            note = f"no friction in the file and {get} enough to hold its weight"
            yield f"{many} {note}: {_listed(self._guessed)}"


def _name_of(body: Mapping[str, Any]) -> str:
    """Return the name of a body's joint, or its own."""
    named = [joint["name"] for joint in body["joints"] if joint["name"]]
    return str(named[0] if named else body["name"] or "unnamed")


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:8]) + (" …" if len(names) > 8 else "")
