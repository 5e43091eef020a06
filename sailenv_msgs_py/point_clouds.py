"""A frame's pixels as an organised `sensor_msgs/PointCloud2`, in the camera's optical frame."""

from __future__ import annotations

import sys

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

from sailenv_ros.frame.frame import Frame

__all__ = ["POINT", "point_cloud_to_msg"]

POINT = np.dtype(
    {
        "names": ["x", "y", "z", "b", "g", "r", "category", "instance"],
        "formats": ["<f4", "<f4", "<f4", "u1", "u1", "u1", "<u2", "<u2"],
        "offsets": [0, 4, 8, 12, 13, 14, 16, 18],
        "itemsize": 20,
    }
)
"""One point as it lies in the message; the colour is PCL's, three bytes of a number of four."""

_FIELDS = (
    ("x", 0, PointField.FLOAT32),
    ("y", 4, PointField.FLOAT32),
    ("z", 8, PointField.FLOAT32),
    ("rgb", 12, PointField.FLOAT32),
    ("category", 16, PointField.UINT16),
    ("instance", 18, PointField.UINT16),
)


def point_cloud_to_msg(frame: Frame, header: Header) -> PointCloud2:
    """Make the message: a point for each pixel, x, y, z NaN where nothing was hit.

    Parameters
    ----------
    frame : Frame
        With the view ``depth``; of ``rgb``, ``category`` and ``instance`` what it has.
    header : Header
        Of the frame; kept, not copied.

    Raises
    ------
    UnknownName
        If the frame has no depth.
    """
    depth = frame["depth"]
    height, width = depth.shape
    table = np.zeros((height, width), POINT)
    points = frame.camera.intrinsics.unproject(depth)
    for axis, name in enumerate("xyz"):
        table[name] = points[..., axis]
    if "rgb" in frame.views:
        for channel, name in enumerate("rgb"):
            table[name] = frame["rgb"][..., channel]
    for view in ("category", "instance"):
        if view in frame.views:
            table[view] = frame[view]
    message = PointCloud2(
        header=header,
        height=height,
        width=width,
        fields=[
            PointField(name=name, offset=offset, datatype=datatype, count=1)
            for name, offset, datatype in _FIELDS
        ],
        is_bigendian=sys.byteorder == "big",
        point_step=POINT.itemsize,
        row_step=width * POINT.itemsize,
        is_dense=False,
    )
    message.data.frombytes(table.tobytes())
    return message
