"""Detections of vision_msgs."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_msgs_py.frame_info import header_of_frame
from sailenv_msgs_py.vision_detections import detections_2d_to_msg, detections_3d_to_msg
from tests.unit.frame.truth.test_object_table import frame_of

pytestmark = pytest.mark.ros


def test_detections_are_the_visible_objects() -> None:
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
