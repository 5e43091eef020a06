"""Converts received messages and arrays to a `Frame`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from numpy.typing import NDArray

from sailenv_msgs_py.frame_info import (
    camera_of_frame_info,
    lesson_of_frame_info,
    randomised_of_frame_info,
    states_of_frame_info,
)
from sailenv_msgs_py.images import view_from_image
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_ros.frame.data import DrawAmodal
from sailenv_ros.frame.frame import Frame
from sailenv_ros.ros.client.frame_sync import Bundle
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import VIEWS

__all__ = ["frame_of_info", "views_of_bundle"]


def views_of_bundle(bundle: Bundle) -> dict[str, NDArray[Any]]:
    """Return the arrays of a bundle, which lie on the messages' bytes; nobody else has them.

    Parameters
    ----------
    bundle : Bundle
        Of `sailenv_msgs/FrameInfo` and `sensor_msgs/Image`.
    """
    return {view: view_from_image(view, image) for view, image in bundle.images.items()}


def frame_of_info(
    info: Any,
    views: Mapping[str, NDArray[Any]],
    intrinsics: CameraIntrinsics,
    scene_info: SceneInfo | None,
    draw_amodal: DrawAmodal | None = None,
) -> Frame:
    """Make one frame of its info and its arrays, which nobody else has.

    Parameters
    ----------
    info : sailenv_msgs/FrameInfo
    views : mapping of str to array
        In any order.
    intrinsics : CameraIntrinsics
        Of the agent that the frame is of.
    scene_info : SceneInfo or None
        The one of the frame's revision, if it is known.
    draw_amodal : callable or None
        As `Frame` has it.
    """
    _keep_freed_memory_once()
    return Frame(
        agent=info.agent,
        scene=info.scene,
        epoch=info.epoch,
        revision=info.revision,
        sequence=info.sequence,
        stamp_ns=ns_from_stamp(info.header.stamp),
        dt_ns=info.dt_ns,
        camera=camera_of_frame_info(info, intrinsics),
        depth_range_m=info.depth_range_m,
        views={view: views[view] for view in VIEWS if view in views},
        timings_s={"render": info.render_s},
        info=scene_info,
        draw_amodal=draw_amodal,
        states=states_of_frame_info(info),
        randomised=randomised_of_frame_info(info),
        lesson=lesson_of_frame_info(info),
    )


@lru_cache(maxsize=1)
def _keep_freed_memory_once() -> None:
    """Keep the memory of frames that were let go, for the frames that follow.

    A frame's bytes are received into some arrays of megabytes each; without this each page of them
    is faulted in anew, which takes longer than the copying.
    """
    keep_freed_memory()
