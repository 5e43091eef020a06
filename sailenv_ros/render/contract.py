"""Contract between the simulation and a renderer.

Imports no graphics library, so that every renderer and the simulation can share it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera
from sailenv_ros.types.listed_views import Views
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import AdaptedExposure, Observation, SceneContents, WorldSnapshot

__all__ = [
    "BACKEND_NAMES",
    "BackendName",
    "RenderBackend",
    "RenderRequest",
    "RenderedViews",
]

BackendName: TypeAlias = Literal["auto", "native", "gl"]

BACKEND_NAMES: tuple[BackendName, ...] = get_args(BackendName)
"""Names of back ends that can be requested."""


@dataclass(frozen=True, eq=False, slots=True)
class RenderRequest:
    """Everything that is asked of a renderer for one frame.

    Attributes
    ----------
    snapshot : WorldSnapshot
        The world now.
    camera : Camera
    views : str or iterable of str
        Names in `frame.VIEWS`.
    previous : Observation or None
        What the same camera saw before, which flow and automatic exposure refer to; None if there
        is nothing.
    rows : RowPoses or None
        Poses of each row where the shutter rolls; snapshot and camera are those of the middle.
    samples : sequence of Observation
        Whose light is averaged in the picture; none: that of the snapshot.
    """

    snapshot: WorldSnapshot
    camera: Camera
    views: Views
    previous: Observation | None = None
    rows: RowPoses | None = None
    samples: Sequence[Observation] = ()


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RenderedViews:
    """Result of one `RenderRequest`.

    Attributes
    ----------
    views : mapping of str to array
        The wanted views as `frame.VIEWS` says; fresh arrays, the caller's own.
    depth : (H, W) float32 or None
        The depth view, wanted or not, if it was made on the way: the next frame's past. Through a
        lens that bends straight lines the view ``range``.
    adapted : AdaptedExposure or None
        Where the camera's exposure is automatic, that of this picture, or without one the previous.
    timings_s : mapping of str to float
        Wall time of each stage [s].
    """

    views: Mapping[str, NDArray[Any]]
    depth: NDArray[np.float32] | None
    adapted: AdaptedExposure | None = None
    timings_s: Mapping[str, float] = field(default_factory=dict)


class RenderBackend(Protocol):
    """A renderer; used by the thread that made it and, but for `preload`, by no other."""

    @property
    def description(self) -> str:
        """One line: back end, device, driver."""

    @property
    def software(self) -> bool:
        """True if no graphics hardware is used."""

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that it can make, in the order of `frame.VIEWS`."""

    def preload(self, contents: SceneContents) -> None:
        """Make ready what their first picture needs, as far as its light does not matter.

        Any thread may call it while no other one uses the renderer.
        """

    def render(self, request: RenderRequest) -> RenderedViews:
        """Make the wanted views of one camera.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such view, or none that this renderer can make.
        """

    def render_all(self, requests: Sequence[RenderRequest]) -> list[RenderedViews]:
        """Make the wanted views of several cameras; see `render`.

        Those of one instant may be drawn side by side; the views do not depend on it.

        Raises
        ------
        UnknownName, InvalidRequest
            As `render`.
        """

    def close(self) -> None:
        """Free everything; a second call does nothing."""
