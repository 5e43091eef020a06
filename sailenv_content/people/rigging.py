"""MakeHuman's rig with the bones that bodies are moved by: joints, and weights of all vertices."""

from __future__ import annotations

import re
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sailenv_content.people.makehuman import BodyData
from sailenv_ros.native.deformation_kernels import INFLUENCES

__all__ = ["joint_names", "joint_parents", "joint_places", "vertex_weights"]

Doubles = NDArray[np.float64]

_KEPT = re.compile(
    r"root|spine0[1-5]|neck0[1-3]|head|(clavicle|shoulder01|upperarm01|lowerarm01|wrist|"
    r"finger[1-5]-[1-3]|upperleg01|lowerleg01|foot|toe1-1)\.[LR]"
)
"""Others move with the nearest one that carries them."""


@lru_cache(maxsize=2)
def _kept(data: BodyData) -> dict[str, str]:
    """Return by which bone of ours each bone of the files moves, in an order from the root."""
    bones = data.bones
    order: list[str] = []

    def visit(name: str) -> None:
        order.append(name)
        for child in sorted(bones):
            if bones[child]["parent"] == name:
                visit(child)

    visit("root")
    found: dict[str, str] = {}
    for name in order:
        toe = re.fullmatch(r"toe.*\.([LR])", name)
        if toe:
            found[name] = f"toe1-1.{toe[1]}"
        else:
            found[name] = name if _KEPT.fullmatch(name) else found[bones[name]["parent"]]
    return found


def joint_names(data: BodyData) -> tuple[str, ...]:
    """Return the names of the joints; each comes after its parent."""
    return tuple(name for name, kept in _kept(data).items() if name == kept)


def joint_parents(data: BodyData) -> NDArray[np.int64]:
    """Return (J,): the parent of each joint, -1 for the root."""
    kept, names = _kept(data), joint_names(data)
    parents = [-1]
    for name in names[1:]:
        parent = data.bones[name]["parent"]
        if name.startswith("toe"):
            parent = f"foot.{name[-1]}"
        parents.append(names.index(kept[parent]))
    return np.array(parents, np.int64)


def joint_places(data: BodyData, vertices: Doubles) -> Doubles:
    """Return (J, 3): where the joints of a body are [m]."""
    return np.array([data.joint(vertices, data.bones[name]["head"]) for name in joint_names(data)])


@lru_cache(maxsize=2)
def vertex_weights(data: BodyData) -> tuple[NDArray[np.uint16], NDArray[np.float32]]:
    """Return (V, 4) joints and (V, 4) weights of all vertices, helpers too."""
    kept, names = _kept(data), joint_names(data)
    dense = np.zeros((len(data.base), len(names)))
    for bone, pairs in data.bone_weights.items():
        if pairs:
            places, weights = np.array(pairs, np.float64).T
            np.add.at(dense[:, names.index(kept[bone])], places.astype(np.int64), weights)
    return strongest(dense)


def strongest(dense: Doubles) -> tuple[NDArray[np.uint16], NDArray[np.float32]]:
    """Return the joints of the largest weights (V, J), and these, with sums of 1."""
    order = np.argsort(-dense, axis=1, kind="stable")[:, :INFLUENCES]
    chosen = np.take_along_axis(dense, order, axis=1)
    chosen /= np.maximum(chosen.sum(axis=1, keepdims=True), 1e-9)
    return order.astype(np.uint16), chosen.astype(np.float32)
