"""A frame's table of objects to `sailenv_msgs/Objects`, and amodal masks to and from messages."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from std_msgs.msg import Header

import sailenv_msgs.msg as msgs
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.object_table import ObjectTable
from sailenv_ros.frame.truth.run_lengths import crop_runs, mask_of_runs

__all__ = [
    "amodal_mask_to_msgs",
    "amodal_masks_from_msgs",
    "objects_to_msg",
    "poses_of",
]


def objects_to_msg(frame: Frame, header: Header, masks: AmodalMasks | None = None) -> msgs.Objects:
    """Make the message of a frame's objects.

    Parameters
    ----------
    frame : Frame
    header : Header
        Of the frame; kept, not copied.
    masks : AmodalMasks or None
        Of the frame; None leaves out what needs them.

    Raises
    ------
    InvalidState
        If the scene of the frame's instant is not known.
    """
    table = frame.objects if masks is None else frame.objects.with_amodal(masks)
    amodal: dict[int, msgs.AmodalMask] = {}
    if masks is not None:
        amodal = {message.id: message for message in amodal_mask_to_msgs(masks)}
    lens = frame.camera.intrinsics
    return msgs.Objects(
        header=header,
        agent=frame.agent,
        sequence=frame.sequence,
        revision=frame.revision,
        height=lens.height,
        width=lens.width,
        objects=_objects(table, amodal),
    )


def amodal_mask_to_msgs(masks: AmodalMasks) -> list[msgs.AmodalMask]:
    """Make the messages of amodal masks; depths are not sent."""
    rows = zip(
        masks.ids.tolist(),
        masks.pixels.tolist(),
        masks.whole_pixels.tolist(),
        masks.boxes,
        masks.whole_boxes,
        masks.crops,
        strict=True,
    )
    return [
        msgs.AmodalMask(
            id=id_,
            pixels=pixels,
            whole_pixels=whole,
            box=box,
            whole_box=whole_box,
            counts=crop_runs(crop, int(box[0]), int(box[1]), masks.height, masks.width)
            if pixels
            else np.array([masks.height * masks.width], np.uint32),
        )
        for id_, pixels, whole, box, whole_box, crop in rows
    ]


def amodal_masks_from_msgs(
    messages: Iterable[msgs.AmodalMask], height: int, width: int
) -> AmodalMasks:
    """Read amodal masks of a picture of that size [px]; they have no depths.

    Raises
    ------
    InvalidRequest
        If run lengths do not add up to the picture's size, or a box does not lie in it.
    """
    found = sorted(messages, key=lambda message: message.id)
    crops = []
    for message in found:
        left, top, right, bottom = (int(edge) for edge in message.box)
        mask = mask_of_runs(message.counts, height, width)
        empty = left < 0
        if not empty and not (0 <= left <= right < width and 0 <= top <= bottom < height):
            raise InvalidRequest("box of an amodal mask", list(message.box), "a box in the picture")
        crop = mask[:0, :0] if empty else mask[top : bottom + 1, left : right + 1]
        crops.append(np.ascontiguousarray(crop))
    return AmodalMasks(
        height=height,
        width=width,
        ids=np.array([message.id for message in found], np.uint16),
        pixels=np.array([message.pixels for message in found], np.int64),
        whole_pixels=np.array([message.whole_pixels for message in found], np.int64),
        boxes=np.array([message.box for message in found], np.int32).reshape(-1, 4),
        whole_boxes=np.array([message.whole_box for message in found], np.int32).reshape(-1, 4),
        crops=tuple(crops),
    )


def poses_of(transforms: np.ndarray[Any, Any]) -> list[Pose]:
    """Make poses of (N, 4, 4) rigid transforms; NaN gives NaN."""
    if not len(transforms):
        return []
    known = np.isfinite(transforms).all(axis=(1, 2))
    quats = np.full((len(transforms), 4), np.nan)
    if known.any():
        from scipy.spatial.transform import Rotation  # takes long to import, and few need it

        quats[known] = Rotation.from_matrix(transforms[known, :3, :3]).as_quat()
    return [
        Pose(
            position=Point(x=place[0], y=place[1], z=place[2]),
            orientation=Quaternion(x=turn[0], y=turn[1], z=turn[2], w=turn[3]),
        )
        for place, turn in zip(transforms[:, :3, 3].tolist(), quats.tolist(), strict=True)
    ]


def _objects(table: ObjectTable, amodal: dict[int, msgs.AmodalMask]) -> list[msgs.ObjectTruth]:
    poses, seen_poses = poses_of(table.world_from_object), poses_of(table.camera_from_object)
    centres, sizes = table.box_centres.tolist(), table.box_sizes.tolist()
    corners = table.corners.tolist()
    linear, angular = table.linear_velocities.tolist(), table.angular_velocities.tolist()
    shares, truncated = table.visible_share.tolist(), table.truncated_share.tolist()
    made = []
    for row, id_ in enumerate(table.ids.tolist()):
        made.append(
            msgs.ObjectTruth(
                id=id_,
                name=table.names[row],
                category_id=int(table.category_ids[row]),
                category=table.categories[row],
                parent=int(table.parents[row]),
                is_static=bool(table.static[row]),
                pose=poses[row],
                camera_pose=seen_poses[row],
                twist=Twist(linear=_vector(linear[row]), angular=_vector(angular[row])),
                box_centre=_point(centres[row]),
                box_size=_vector(sizes[row]),
                corners=[_point(corner) for corner in corners[row]],
                corner_pixels=table.corner_pixels[row].reshape(-1),
                corners_visible=table.corners_visible[row].tolist(),
                distance=float(table.distances[row]),
                visible_pixels=int(table.visible_pixels[row]),
                visible_box=table.visible_boxes[row],
                flow=table.flow[row],
                visible_share=shares[row],
                truncated_share=truncated[row],
                amodal=amodal.get(id_) or _no_mask(id_),
            )
        )
    return made


def _no_mask(id_: int) -> msgs.AmodalMask:
    nowhere = np.full(4, -1, np.int32)
    return msgs.AmodalMask(id=id_, pixels=-1, whole_pixels=-1, box=nowhere, whole_box=nowhere)


def _point(xyz: list[float]) -> Point:
    return Point(x=xyz[0], y=xyz[1], z=xyz[2])


def _vector(xyz: list[float]) -> Vector3:
    x, y, z = (value if math.isfinite(value) else math.nan for value in xyz)
    return Vector3(x=x, y=y, z=z)
