"""A frame's visible objects as `vision_msgs` detections."""

from __future__ import annotations

from copy import copy

import numpy as np
from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import Header
from vision_msgs.msg import (
    BoundingBox2D,
    BoundingBox3D,
    Detection2D,
    Detection2DArray,
    Detection3D,
    Detection3DArray,
    ObjectHypothesis,
    ObjectHypothesisWithPose,
    Point2D,
    Pose2D,
)

from sailenv_msgs_py.object_truth_msgs import poses_of
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.object_table import ObjectTable

__all__ = ["detections_2d_to_msg", "detections_3d_to_msg"]


def detections_2d_to_msg(frame: Frame, header: Header) -> Detection2DArray:
    """Make a `Detection2DArray`: the box around the visible pixels of each object, in pixels.

    The box is that of `sailenv_msgs/ObjectTruth`; its centre and size count whole pixels, so that a
    single pixel at (u, v) has the centre u, v and the size 1, 1. The class is the category's name,
    the id the object's instance id.
    """
    table = _visible(frame)
    found = []
    for row, (left, top, right, bottom) in enumerate(table.visible_boxes.tolist()):
        middle = Point2D(x=0.5 * (left + right), y=0.5 * (top + bottom))
        box = BoundingBox2D(
            center=Pose2D(position=middle, theta=0.0),
            size_x=float(right - left + 1),
            size_y=float(bottom - top + 1),
        )
        found.append(
            Detection2D(
                header=copy(header),
                results=[_hypothesis(table, row)],
                bbox=box,
                id=str(table.ids[row]),
            )
        )
    return Detection2DArray(header=header, detections=found)


def detections_3d_to_msg(frame: Frame, header: Header) -> Detection3DArray:
    """Make a `Detection3DArray`: the oriented box of each visible object, in the optical frame."""
    table = _visible(frame)
    boxes = table.camera_from_object.copy()
    to_camera = frame.camera.camera_from_world
    boxes[:, :3, 3] = table.box_centres @ to_camera[:3, :3].T + to_camera[:3, 3]
    found = []
    for row, (pose, size) in enumerate(zip(poses_of(boxes), table.box_sizes.tolist(), strict=True)):
        hypothesis = _hypothesis(table, row)
        hypothesis.pose.pose = pose
        box = BoundingBox3D(center=pose, size=Vector3(x=size[0], y=size[1], z=size[2]))
        found.append(
            Detection3D(header=copy(header), results=[hypothesis], bbox=box, id=str(table.ids[row]))
        )
    return Detection3DArray(header=header, detections=found)


def _visible(frame: Frame) -> ObjectTable:
    table = frame.objects
    return table.select(table.visible & np.isfinite(table.distances))


def _hypothesis(table: ObjectTable, row: int) -> ObjectHypothesisWithPose:
    result = ObjectHypothesisWithPose(
        hypothesis=ObjectHypothesis(class_id=table.categories[row], score=1.0)
    )
    x, y, z = table.camera_from_object[row, :3, 3].tolist()
    result.pose.pose.position = Point(x=x, y=y, z=z)
    return result
