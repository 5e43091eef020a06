"""What a client received, as its own nouns: a bundle of messages → the dict of one frame."""

from __future__ import annotations

from typing import Any

from sailenv_msgs_py.frame_info import camera_of_frame_info
from sailenv_msgs_py.images import view_from_image
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_ros.agent.frame_dict import frame_dict
from sailenv_ros.agent.frame_sync import Bundle
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.frame import VIEWS

__all__ = ["frame_of_bundle"]


def frame_of_bundle(bundle: Bundle, intrinsics: CameraIntrinsics) -> dict[str, Any]:
    """Make the dict of one frame; its arrays lie on the messages' bytes, which nobody else has.

    Parameters
    ----------
    bundle : Bundle
        Of `sailenv_msgs/FrameInfo` and `sensor_msgs/Image`.
    intrinsics : CameraIntrinsics
        Of the agent that the frame is of.

    Returns
    -------
    frame : dict
        See `frame_dict`.
    """
    info, images = bundle.info, bundle.images
    return frame_dict(
        {view: view_from_image(view, images[view]) for view in VIEWS if view in images},
        camera=camera_of_frame_info(info, intrinsics),
        depth_range_m=info.depth_range_m,
        scene=info.scene,
        sequence=bundle.sequence,
        stamp_ns=ns_from_stamp(info.header.stamp),
        dt_ns=info.dt_ns,
        render_s=info.render_s,
    )
