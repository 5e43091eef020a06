"""The table of all views of a frame.

`VIEWS` says it once: code that makes, shows, sends, stores or documents views reads it there and
names none of its own.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from types import MappingProxyType

import numpy as np

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.bayer import BLACK_LEVEL, WHITE_LEVEL
from sailenv_ros.types.listed_views import Views, listed_views
from sailenv_ros.types.view_spec import ViewSource, ViewSpec

__all__ = [
    "ALWAYS_MADE",
    "FIVE_VIEWS",
    "LIT_VIEWS",
    "RENDERED_VIEWS",
    "VIEWS",
    "checked_views",
    "view_spec",
    "views_of",
]

_SPECS = (
    ViewSpec(
        name="rgb",
        dtype=np.dtype(np.uint8),
        channels=3,
        encoding="rgb8",
        meaning="the picture: red, green, blue (sRGB)",
        display="colour",
        source="lighting",
        by_default=True,
        compressed_topic="jpeg",
    ),
    ViewSpec(
        name="depth",
        dtype=np.dtype(np.float32),
        encoding="32FC1",
        meaning="depth along the optical axis",
        unit="m",
        invalid="+inf nothing hit, NaN nearer than the near plane or not seen by the lens",
        display="depth",
        source="annotation",
        by_default=True,
        color_topic=True,
        compressed_topic="inverse depth",
        png_per_unit=1000.0,
    ),
    ViewSpec(
        name="category",
        dtype=np.dtype(np.uint8),
        encoding="8UC1",
        wide_dtype=np.dtype(np.uint16),
        wide_encoding="16UC1",
        meaning="category id",
        invalid="0 background, 255 unlabelled",
        display="category",
        source="annotation",
        by_default=True,
        color_topic=True,
        compressed_topic="png",
    ),
    ViewSpec(
        name="instance",
        dtype=np.dtype(np.uint16),
        encoding="16UC1",
        meaning="instance id",
        invalid="0 background",
        display="instance",
        source="annotation",
        by_default=True,
        color_topic=True,
        compressed_topic="png",
    ),
    ViewSpec(
        name="flow",
        dtype=np.dtype(np.float32),
        channels=2,
        encoding="32FC2",
        meaning="velocity in the image, u right, v down",
        unit="px/s",
        invalid="NaN where it does not exist",
        display="flow",
        source="annotation",
        needs_past=True,
        by_default=True,
        color_topic=True,
    ),
    ViewSpec(
        name="flow_valid",
        dtype=np.dtype(np.bool_),
        encoding="8UC1",
        meaning="True where the surface point had a place in the previous frame's image plane",
        display="mask",
        source="annotation",
        needs_past=True,
        validity_of="flow",
    ),
    ViewSpec(
        name="occlusion",
        dtype=np.dtype(np.bool_),
        encoding="8UC1",
        meaning="True where the surface point was not visible in the previous frame",
        display="mask",
        source="annotation",
        needs_past=True,
        needs_past_depth=True,
    ),
    ViewSpec(
        name="range",
        dtype=np.dtype(np.float32),
        encoding="32FC1",
        meaning="distance along the ray, also through a lens that sees behind the camera",
        unit="m",
        invalid="+inf nothing hit, NaN nearer than the near plane or not seen by the lens",
        display="depth",
        source="annotation",
        png_per_unit=1000.0,
    ),
    ViewSpec(
        name="lens_valid",
        dtype=np.dtype(np.bool_),
        encoding="8UC1",
        meaning="True where a ray leads through the lens to the pixel's centre",
        display="mask",
        source="annotation",
    ),
    ViewSpec(
        name="normals",
        dtype=np.dtype(np.float32),
        channels=3,
        encoding="32FC3",
        meaning="unit surface normal in the optical frame",
        invalid="0 nothing hit",
        display="direction",
        source="geometry",
    ),
    ViewSpec(
        name="albedo",
        dtype=np.dtype(np.float32),
        channels=3,
        encoding="32FC3",
        meaning="base colour of the surface, whatever its light: red, green, blue (linear)",
        invalid="0 nothing hit",
        display="colour",
        source="geometry",
    ),
    ViewSpec(
        name="uv",
        dtype=np.dtype(np.float32),
        channels=2,
        encoding="32FC2",
        meaning="texture coordinates of the surface, in repeats of its texture: u right, v up",
        invalid="0 nothing hit",
        display="flow",
        source="geometry",
    ),
    ViewSpec(
        name="metallic_roughness",
        dtype=np.dtype(np.float32),
        channels=2,
        encoding="32FC2",
        meaning="metalness and perceptual roughness of the surface, each 0 to 1",
        invalid="0 nothing hit",
        display="flow",
        source="geometry",
    ),
    ViewSpec(
        name="measured_depth",
        dtype=np.dtype(np.float32),
        encoding="32FC1",
        meaning="depth along the optical axis as the agent's depth sensor measures it",
        unit="m",
        invalid="NaN nothing measured",
        display="depth",
        source="measurement",
        color_topic=True,
        compressed_topic="inverse depth",
        png_per_unit=1000.0,
    ),
    ViewSpec(
        name="raw",
        dtype=np.dtype(np.uint16),
        encoding="bayer_rggb16",
        meaning="RAW data of the sensor behind a Bayer filter (RGGB), linear: "
        f"{BLACK_LEVEL} is black, {WHITE_LEVEL} white",
        display="mosaic",
        source="lighting",
    ),
    ViewSpec(
        name="object_coords",
        dtype=np.dtype(np.float32),
        channels=3,
        encoding="32FC3",
        meaning="surface point in its instance's own frame",
        unit="m",
        invalid="NaN nothing hit or nearer than the near plane",
        display="place",
        source="annotation",
    ),
    ViewSpec(
        name="flow_forward",
        dtype=np.dtype(np.float32),
        channels=2,
        encoding="32FC2",
        meaning="displacement in the image to the next frame, u right, v down",
        unit="px",
        invalid="NaN where it does not exist",
        display="flow",
        source="motion",
        needs_next=True,
    ),
    ViewSpec(
        name="scene_flow",
        dtype=np.dtype(np.float32),
        channels=3,
        encoding="32FC3",
        meaning="displacement of the surface point in the world to the next frame, optical axes",
        unit="m",
        invalid="NaN where it does not exist",
        display="displacement",
        source="motion",
        needs_next=True,
    ),
)

VIEWS: Mapping[str, ViewSpec] = MappingProxyType({spec.name: spec for spec in _SPECS})
"""Every view by name."""

FIVE_VIEWS: tuple[str, ...] = tuple(name for name, spec in VIEWS.items() if spec.by_default)
"""Views of an agent unless it asks for others."""


ALWAYS_MADE: tuple[str, ...] = ("depth",)
"""Views that cost nothing beside any other: for a frame of which only the camera is wanted."""

RENDERED_VIEWS: tuple[str, ...] = tuple(name for name, spec in VIEWS.items() if not spec.needs_next)
"""Views that a frame can have as soon as it is rendered."""


def view_spec(name: str) -> ViewSpec:
    """Return the entry of one view.

    Raises
    ------
    UnknownName
        If there is no view of that name.
    """
    if name not in VIEWS:
        raise UnknownName("view", name, VIEWS)
    return VIEWS[name]


def views_of(*sources: ViewSource) -> tuple[str, ...]:
    """Return the views that one of these sources makes, in the order of `VIEWS`."""
    return tuple(name for name, spec in VIEWS.items() if spec.source in sources)


LIT_VIEWS = frozenset(views_of("lighting"))
"""Views of light: a frame without them needs none."""


def checked_views(names: Views, *, supported: Collection[str] | None = None) -> tuple[str, ...]:
    """Check names of views: known, at least one, each once; in the order of `VIEWS`.

    Parameters
    ----------
    names : str or iterable of str
    supported : collection of str or None
        What the renderer can make; None if that is not known here.

    Raises
    ------
    UnknownName
        If a name is not in `VIEWS`.
    InvalidRequest
        If there is none, or one that the renderer cannot make.
    """
    wanted = set(listed_views(names))
    for name in sorted(wanted):
        view_spec(name)
    if not wanted:
        raise InvalidRequest("views", (), f"at least one of: {', '.join(VIEWS)}")
    ordered = tuple(name for name in VIEWS if name in wanted)
    missing = [] if supported is None else [name for name in ordered if name not in supported]
    late = [name for name in missing if VIEWS[name].needs_next]
    if late:
        raise InvalidRequest(
            "views",
            late,
            "views that are known with the frame itself; these are known with the next one: take "
            "motion(frame, next_frame), a recording or their topics",
        )
    if supported is not None and missing:
        offered = ", ".join(name for name in VIEWS if name in supported)
        raise InvalidRequest("views", missing, f"among those that this renderer makes: {offered}")
    return ordered
