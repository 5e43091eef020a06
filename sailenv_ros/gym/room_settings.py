"""Names and types of the settings that all environments have."""

from __future__ import annotations

from collections.abc import Sequence

from typing_extensions import TypedDict

from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.listed_views import Views
from sailenv_ros.types.picture_settings import PictureSettings

__all__ = ["FAST_PICTURE", "RoomSettings"]

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
