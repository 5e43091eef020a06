"""Names and types of the settings that all environments have."""

from __future__ import annotations

from collections.abc import Sequence

from typing_extensions import TypedDict

from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.listed_views import Views
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND
from sailenv_ros.types.validation import Bounds

__all__ = ["FAST_PICTURE", "STEP_NS", "THREADS", "RoomSettings"]

STEP_NS = round(8e9 / STEPS_PER_SECOND)
"""Simulated time of one step: eight steps of physics, 1/30 s [ns]."""

THREADS = Bounds(least=1, most=256, whole=True)

FAST_PICTURE = PictureSettings(smooth_edges=False)
"""Pictures unless told otherwise: edges are not smoothed, which takes longer than all else."""


class RoomSettings(TypedDict, total=False):
    """Settings of every environment; see `RoomEnv`."""

    views: Views
    width: int
    height: int
    vertical_fov_deg: float
    intrinsics: CameraIntrinsics | None
    picture: PictureSettings
    most_depth_m: float
    retina: tuple[int, int] | None
    split: str
    rooms: int | Sequence[str]
    kinds: Sequence[str]
    baked: bool
    discrete: bool
    threads: int
    render_mode: str | None
