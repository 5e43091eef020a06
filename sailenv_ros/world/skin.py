"""Skin over a skeleton: joints in, the vertices of a model out."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.deformation_kernels import skin
from sailenv_ros.postures.skeleton import Posture, joint_frames, skin_matrices
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.model import Asset, Model
from sailenv_ros.types.rig import Rig
from sailenv_ros.types.skeleton import Skeleton

__all__ = ["ContactSkin", "contact_skin", "skin_over", "skin_over_skeleton"]

Doubles = NDArray[np.float64]


_HAIR = "hair"
"""Materials of hair begin so: it gives way where a body lies on it."""


class ContactSkin(NamedTuple):
    """The skin and the clothes with which a body touches things.

    Attributes
    ----------
    joints : (V,) int64
        The joint that moves each vertex most.
    places : callable
        ``places(posture)``: (V, 3) where they are, body frame before the scale [m].
    """

    joints: NDArray[np.int64]
    places: Callable[[Posture], Doubles]


def contact_skin(asset: Asset) -> ContactSkin:
    """Return what of a person touches things."""
    rig, parts = asset.rig, asset.model.parts
    assert rig is not None
    chosen = [n for n, part in enumerate(parts) if not part.material.name.startswith(_HAIR)]
    joints = np.concatenate([
        rig.bones[n][np.arange(len(rig.bones[n])), rig.weights[n].argmax(axis=1)] for n in chosen
    ]).astype(np.int64)  # fmt: skip

    def places(posture: Posture) -> Doubles:
        matrices = skin_matrices(rig, *joint_frames(rig, posture))
        meshes = skin_over(asset.model, rig, matrices).meshes
        return np.concatenate([meshes[n].positions for n in chosen]).astype(np.float64)

    return ContactSkin(joints, places)


def skin_over(model: Model, rig: Rig, matrices: Doubles) -> Deformation:
    """Return the vertices of a model.

    Parameters
    ----------
    model : Model
        At rest.
    rig : Rig
        Of that model.
    matrices : (J, 3, 4) float64
        Where each joint takes what is at rest, body frame before the scale.
    """

    def made() -> Iterable[tuple[NDArray[np.float32], NDArray[np.float32]]]:
        given = (model.positions, model.normals, *rig.skin, matrices)
        ends = model.first_vertices[1:-1]
        moved, turned = (np.split(one, ends) for one in skin(*given, threads=thread_count()))
        return zip(moved, turned, strict=True)

    return Deformation(model, made)


def skin_over_skeleton(
    asset: Asset, skeleton: Skeleton, world_from_body: Doubles, scale: float
) -> Deformation:
    """Return the vertices of a person whose joints are known in the world.

    Parameters
    ----------
    asset : Asset
        With a rig.
    skeleton : Skeleton
        Of the same joints.
    world_from_body : (4, 4) float64
    scale : float
        Along all axes.

    Raises
    ------
    InvalidRequest
        If the asset has no such joints.
    """
    rig = asset.rig
    if rig is None or rig.names != skeleton.joint_names:
        raise InvalidRequest("asset", asset.name, "one with the joints of the skeleton")
    body_from_world = invert(world_from_body)
    rotation, joints = body_from_world[:3, :3], skeleton.world_from_joint
    places = (joints[:, :, 3] @ rotation.T + body_from_world[:3, 3]) / scale
    return skin_over(asset.model, rig, skin_matrices(rig, rotation @ joints[:, :, :3], places))
