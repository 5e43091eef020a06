"""Frames with their motion to the next frame: the views ``flow_forward`` and ``scene_flow``.

Frames in their order in, the same frames one later out: what comes next must be known first.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion.between import motion
from sailenv_ros.types.listed_views import Views, listed_views
from sailenv_ros.types.views import VIEWS, checked_views

__all__ = ["FORWARD_VIEWS", "forward_views", "with_forward_motion"]

FORWARD_VIEWS: tuple[str, ...] = tuple(name for name, spec in VIEWS.items() if spec.needs_next)
"""Views that are known once the next frame of the same camera is."""


def forward_views(
    frame: Frame, following: Frame | None, views: Views = FORWARD_VIEWS
) -> dict[str, NDArray[Any]]:
    """Return a frame's views of its motion to the frame that follows it.

    Parameters
    ----------
    frame : Frame
    following : Frame or None
        The same agent's next frame; None or one of another epoch gives views that are nan.
    views : str or iterable of str
        Among `FORWARD_VIEWS`.

    Raises
    ------
    InvalidRequest
        As `motion`.
    """
    wanted = listed_views(views)
    if following is None or (following.scene, following.epoch) != (frame.scene, frame.epoch):
        height, width = frame.camera.intrinsics.height, frame.camera.intrinsics.width
        return {
            view: np.full(VIEWS[view].shape(height, width), np.nan, np.float32) for view in wanted
        }
    moved = motion(frame, following)
    made = {"flow_forward": moved.flow, "scene_flow": moved.scene_flow}
    return {view: made[view] for view in wanted}


def with_forward_motion(frames: Iterable[Frame], views: Views = FORWARD_VIEWS) -> Iterator[Frame]:
    """Return frames with the motion to the next frame of the same agent as views.

    Each frame is given when the agent's next frame of a later instant has come; what is left at
    the end has no motion (nan).

    Parameters
    ----------
    frames : iterable of Frame
        In their order; of several agents if need be. They need the views ``depth`` and
        ``instance``.
    views : str or iterable of str
        Among `FORWARD_VIEWS`.

    Raises
    ------
    InvalidRequest
        If a view is not among them, or a frame lacks what motion needs.
    """
    wanted = checked_views(views)
    if not {*wanted} <= {*FORWARD_VIEWS}:
        raise InvalidRequest("views", wanted, f"among {', '.join(FORWARD_VIEWS)}")
    waiting: list[Frame] = []
    nexts: dict[tuple[str, int], Frame] = {}
    for frame in frames:
        waiting.append(frame)
        for earlier in waiting:
            # Frames of one instant share what follows them.
            if earlier.agent == frame.agent and _is_later(frame, earlier):
                nexts.setdefault((earlier.agent, earlier.sequence), frame)
        while waiting and (waiting[0].agent, waiting[0].sequence) in nexts:
            done = waiting.pop(0)
            yield _with_views(done, nexts.pop((done.agent, done.sequence)), wanted)
    for frame in waiting:
        yield _with_views(frame, nexts.get((frame.agent, frame.sequence)), wanted)


def _is_later(frame: Frame, earlier: Frame) -> bool:
    return frame.epoch != earlier.epoch or frame.stamp_ns > earlier.stamp_ns


def _with_views(frame: Frame, following: Frame | None, views: Sequence[str]) -> Frame:
    return replace(frame, views={**frame.views, **forward_views(frame, following, views)})
