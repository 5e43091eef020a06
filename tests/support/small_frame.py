"""Frames of a few pixels, for tests that look at their arrays alone."""

from __future__ import annotations

from typing import Any

from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.camera import Camera, CameraIntrinsics


def small_frame(views: dict[str, Any], width: int = 8, height: int = 8, **more: Any) -> Frame:
    """Return a frame of these arrays; `more` are entries that a first frame has otherwise."""
    camera = Camera(intrinsics=CameraIntrinsics(width=width, height=height))
    first = {"agent": "eye", "scene": "tiny", "epoch": 1, "revision": 1, "sequence": 1}
    return Frame(**{**first, "stamp_ns": 0, "dt_ns": 0, "camera": camera, **more}, views=views)
