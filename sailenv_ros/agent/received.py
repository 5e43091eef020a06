"""What a client received, as its own nouns: a bundle of messages → the dict of one frame."""

from __future__ import annotations

from typing import Any

from sailenv_msgs_py.images import view_from_image
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_msgs_py.transforms import pose_from_msg
from sailenv_ros.agent.frame_dict import frame_dict
from sailenv_ros.agent.frame_sync import Bundle
from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.frame import VIEWS
from sailenv_ros.geometry import BODY_FROM_OPTICAL, Pose, invert

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
    world_from_optical = pose_from_msg(info.camera_pose).matrix()
    pose = Pose.from_matrix(world_from_optical @ invert(BODY_FROM_OPTICAL))
    return frame_dict(
        {view: view_from_image(view, images[view]) for view in VIEWS if view in images},
        camera=Camera(intrinsics=intrinsics, pose=pose),
        depth_range_m=info.depth_range_m,
        scene=info.scene,
        sequence=bundle.sequence,
        stamp_ns=ns_from_stamp(info.header.stamp),
        dt_ns=info.dt_ns,
        render_s=info.render_s,
    )
