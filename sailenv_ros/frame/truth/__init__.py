"""Ground truth of each object in a frame: table, boxes, amodal masks, points of a cloud.

Data types and pure functions on a `Frame`; `Frame.objects`, `Frame.amodal` and `Frame.points` lead
here. Draws nothing itself.
"""

from __future__ import annotations

from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.object_table import Keypoints, ObjectTable
from sailenv_ros.frame.truth.point_cloud import PointCloud
from sailenv_ros.frame.truth.visible_parts import VisibleParts, visible_parts

__all__ = [
    "AmodalMasks",
    "Keypoints",
    "ObjectTable",
    "PointCloud",
    "VisibleParts",
    "visible_parts",
]
