"""Detections of vision_msgs, which PyPI lacks: by classes made of its definitions.

The fields are those of vision_msgs 4.1 (ros-perception/vision_msgs, branch ros2); a name that is
none of them is refused, as rclpy's classes do it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Pose, PoseWithCovariance, Vector3
from std_msgs.msg import Header

from sailenv_msgs_py.frame_info import header_of_frame
from sailenv_msgs_py.vision_detections import detections_2d_to_msg, detections_3d_to_msg
from tests.unit.frame.truth.test_object_table import frame_of

pytestmark = pytest.mark.ros

DEFINITIONS: dict[str, dict[str, Any]] = {
    "Point2D": {"x": float, "y": float},
    "Pose2D": {"position": "Point2D", "theta": float},
    "BoundingBox2D": {"center": "Pose2D", "size_x": float, "size_y": float},
    "BoundingBox3D": {"center": Pose, "size": Vector3},
    "ObjectHypothesis": {"class_id": str, "score": float},
    "ObjectHypothesisWithPose": {"hypothesis": "ObjectHypothesis", "pose": PoseWithCovariance},
    "Detection2D": {"header": Header, "results": list, "bbox": "BoundingBox2D", "id": str},
    "Detection3D": {"header": Header, "results": list, "bbox": "BoundingBox3D", "id": str},
    "Detection2DArray": {"header": Header, "detections": list},
    "Detection3DArray": {"header": Header, "detections": list},
}


@pytest.fixture
def vision_msgs(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The package's messages, made of their definitions."""
    module = ModuleType("vision_msgs.msg")
    for name, fields in DEFINITIONS.items():
        setattr(module, name, message_class(module, name, fields))
    package = ModuleType("vision_msgs")
    monkeypatch.setitem(sys.modules, "vision_msgs", package)
    monkeypatch.setitem(sys.modules, "vision_msgs.msg", module)
    return module


def message_class(module: ModuleType, name: str, fields: dict[str, Any]) -> Callable[..., Any]:
    def begin(self: Any, **given: Any) -> None:
        assert given.keys() <= fields.keys(), f"{name} has no {given.keys() - fields.keys()}"
        for field, kind in fields.items():
            made = getattr(module, kind) if isinstance(kind, str) else kind
            value = given[field] if field in given else made()
            assert isinstance(value, made), f"{name}.{field} is a {type(value).__name__}"
            setattr(self, field, value)

    return type(name, (), {"__init__": begin})


def test_detections_are_the_visible_objects(vision_msgs: ModuleType) -> None:
    """Boxes by their centres and sizes, in pixels and in the optical frame; names and ids."""
    instance = np.zeros((30, 40), np.uint16)
    instance[5:20, 7:31] = 3
    frame = frame_of(instance=instance)
    header = header_of_frame(frame)
    (flat,) = detections_2d_to_msg(frame, header).detections
    assert (flat.bbox.center.position.x, flat.bbox.center.position.y) == (18.5, 12.0)
    assert (flat.bbox.size_x, flat.bbox.size_y) == (24.0, 15.0)
    assert (flat.id, flat.results[0].hypothesis.class_id) == ("3", "cube")
    assert flat.header == header
    (solid,) = detections_3d_to_msg(frame, header).detections
    table = frame.objects
    centre = np.append(table.box_centres[0], 1.0)
    expected = frame.camera.camera_from_world @ centre
    place = solid.bbox.center.position
    np.testing.assert_allclose((place.x, place.y, place.z), expected[:3], atol=1e-12)
    assert (solid.bbox.size.x, solid.bbox.size.y, solid.bbox.size.z) == (1.0, 0.5, 1.0)
    assert detections_2d_to_msg(frame_of(), header).detections == []
