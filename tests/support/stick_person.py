"""A person of sticks: the joints that people have, with a box around each bone."""

from __future__ import annotations

import numpy as np

from sailenv_ros.types.model import Asset, CylinderShape, Material, Mesh, Model, ModelPart
from sailenv_ros.types.rig import Rig, RigPoint
from sailenv_ros.types.skeleton import COCO_KEYPOINTS
from tests.support.tiny_scenes import box_mesh

_MIDDLE = {
    "root": ("", (-0.05, 0.0, 0.95)),
    "spine05": ("root", (0.0, 0.0, 0.98)),
    "spine03": ("spine05", (0.0, 0.0, 1.10)),
    "spine02": ("spine03", (0.0, 0.0, 1.22)),
    "spine01": ("spine02", (0.0, 0.0, 1.34)),
    "neck01": ("spine01", (0.0, 0.0, 1.48)),
    "neck02": ("neck01", (0.01, 0.0, 1.52)),
    "neck03": ("neck02", (0.02, 0.0, 1.55)),
    "head": ("neck03", (0.02, 0.0, 1.59)),
}
_LEFT = {
    "shoulder01": ("spine01", (0.0, 0.10, 1.43)),
    "upperarm01": ("shoulder01", (0.0, 0.17, 1.41)),
    "lowerarm01": ("upperarm01", (0.0, 0.36, 1.22)),
    "wrist": ("lowerarm01", (0.05, 0.53, 1.06)),
    "upperleg01": ("root", (0.0, 0.10, 0.92)),
    "lowerleg01": ("upperleg01", (0.02, 0.13, 0.50)),
    "foot": ("lowerleg01", (0.0, 0.16, 0.08)),
    "toe1-1": ("foot", (0.14, 0.16, 0.02)),
}
_FINGERS = {
    f"finger{finger}-{joint}": (
        "wrist" if joint == 1 else f"finger{finger}-{joint - 1}",
        (0.13 - 0.02 * finger, 0.56 + 0.03 * joint, 1.03 - 0.03 * joint),
    )
    for finger in range(1, 6)
    for joint in (1, 2, 3)
}
_POINTS = {
    "shoulder": "upperarm01", "elbow": "lowerarm01", "wrist": "wrist",
    "hip": "upperleg01", "knee": "lowerleg01", "ankle": "foot",
}  # fmt: skip


def stick_person(name: str = "stick", *, labelled: bool = False) -> Asset:
    """A person 1.75 m tall, of boxes; the mesh of its head is a part if it is labelled."""
    joints: dict[str, tuple[str, tuple[float, float, float]]] = dict(_MIDDLE)
    for bone, (parent, (x, y, z)) in {**_LEFT, **_FINGERS}.items():
        for side, sign in (("L", 1.0), ("R", -1.0)):
            carrier = parent if parent in _MIDDLE else f"{parent}.{side}"
            joints[f"{bone}.{side}"] = (carrier, (x, sign * y, z))
    names = tuple(joints)
    parents = np.array([names.index(parent) if parent else -1 for parent, _ in joints.values()])
    heads = np.array([place for _, place in joints.values()])
    positions, normals, uvs, triangles, bones = [], [], [], [], []
    count = 0
    for number, place in enumerate(heads):
        box = box_mesh(0.06 if "finger" not in names[number] else 0.015)
        positions.append(box.positions + place.astype(np.float32))
        normals.append(box.normals)
        uvs.append(box.uvs)
        triangles.append(box.triangles + np.uint32(count))
        bones.append(np.full(len(box.positions), number))
        count += len(box.positions)
    joint_of = np.concatenate(bones)
    is_head = joint_of == names.index("head")
    whole = [np.concatenate(part) for part in (positions, normals, uvs)]
    corners = np.concatenate(triangles)
    meshes, weights, groups = [], [], []
    for chosen in (~is_head, is_head):
        used = np.flatnonzero(chosen)
        place = np.cumsum(chosen) - 1
        meshes.append(
            Mesh(
                positions=whole[0][used],
                normals=whole[1][used],
                uvs=whole[2][used],
                triangles=place[corners[chosen[corners].all(axis=1)]].astype(np.uint32),
            )
        )
        own = np.zeros((len(used), 4), np.uint16)
        own[:, 0] = joint_of[used]
        share = np.zeros((len(used), 4), np.float32)
        share[:, 0] = 1.0
        groups.append(own)
        weights.append(share)
    look = Material(base_colour=(0.7, 0.4, 0.3, 1.0))
    model = Model(name=name, parts=tuple(ModelPart(mesh=mesh, material=look) for mesh in meshes))
    del labelled
    return Asset(
        name=name,
        display_name="Stick person",
        category="person",
        model=model,
        collision=(CylinderShape(radius_m=0.22, height_m=1.75, centre_m=(0.0, 0.0, 0.875)),),
        mass_kg=70.0,
        rig=Rig(
            names=names,
            parents=parents.astype(np.int64),
            heads=heads,
            bones=tuple(groups),
            weights=tuple(weights),
            points=tuple(_point(names, heads, name) for name in COCO_KEYPOINTS),
        ),
    )


def _point(names: tuple[str, ...], heads: np.ndarray, point: str) -> RigPoint:
    side, _, what = point.partition(" ")
    if what in _POINTS:
        number = names.index(f"{_POINTS[what]}.{side[0].upper()}")
        x, y, z = heads[number].tolist()
    else:
        number = names.index("head")
        y = {"left": 0.04, "right": -0.04}.get(side, 0.0)
        x, z = (0.0 if what == "ear" else 0.1), 1.66
    return RigPoint(name=point, joint=number, position_m=(x, y, z))
