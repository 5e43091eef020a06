"""Specification of one view of a frame: its array, unit, source, display, topic and file format."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

__all__ = ["ImageCodec", "ViewDisplay", "ViewSource", "ViewSpec"]

ViewSource: TypeAlias = Literal["lighting", "annotation", "geometry", "measurement", "motion"]
"""Source of a view: light on the sensor; arithmetic on depth and instance id, which all back ends
share; an attribute of the surface, which renderers write as it is; what a depth sensor makes of
them; or arithmetic on a frame and the one that follows it, which no renderer makes
(`sailenv_ros.frame.motion`)."""

ViewDisplay: TypeAlias = Literal[
    "colour",
    "mosaic",
    "depth",
    "category",
    "instance",
    "flow",
    "direction",
    "mask",
    "place",
    "displacement",
]
"""Display of a view as a picture; `pictures.colours` has a function for each."""

ImageCodec: TypeAlias = Literal["jpeg", "png", "inverse depth"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewSpec:
    """Specification of one view.

    Attributes
    ----------
    name : str
    dtype : numpy dtype
    channels : int
        1 means an array (H, W), otherwise (H, W, channels).
    encoding : str
        Encoding on a ROS topic (`sensor_msgs/image_encodings`).
    meaning : str
        One line: what a value is, in which unit and frame.
    unit : str
        Of the values, as it is shown to people; empty for none.
    invalid : str
        Values that stand for something else than a measurement; empty if there are none.
    source : {'lighting', 'annotation', 'geometry', 'measurement', 'motion'}
        What makes it. A view of 'geometry' is an output of the geometry pass of the same name.
    needs_past : bool
        True if the view refers to an earlier frame of the same camera.
    needs_past_depth : bool
        True if the depth of that earlier frame is needed too.
    needs_next : bool
        True if the view refers to the next frame of the same camera: it is known one frame late.
    by_default : bool
        True if an agent gets it without asking.
    wide_dtype : numpy dtype or None
        Type of its values where they are too large for `dtype`; None if they never are.
    wide_encoding : str
        Encoding on a ROS topic of these.
    display : str
        How it is shown as a picture.
    color_topic : bool
        True if it has a topic `<view>/color` with that picture.
    compressed_topic : {'jpeg', 'png', 'inverse depth'} or None
        Codec of the topic `compressed_name`; None if there is no such topic. A picture and a depth
        may lose something, labels may not.
    png_per_unit : float or None
        Steps per unit of its 16-bit PNG files; None if files hold the values themselves, or the
        picture of values that are no integers.
    validity_of : str
        The view whose values it says to exist; empty for others.
    """

    name: str
    dtype: np.dtype[Any]
    channels: int = 1
    encoding: str
    meaning: str
    display: ViewDisplay
    source: ViewSource
    unit: str = ""
    invalid: str = ""
    needs_past: bool = False
    needs_past_depth: bool = False
    needs_next: bool = False
    by_default: bool = False
    color_topic: bool = False
    compressed_topic: ImageCodec | None = None
    png_per_unit: float | None = None
    validity_of: str = ""
    wide_dtype: np.dtype[Any] | None = None
    wide_encoding: str = ""

    @property
    def compressed_name(self) -> str:
        """Name of its compressed topic, as image_transport's plugins expect it."""
        kind = "compressedDepth" if self.compressed_topic == "inverse depth" else "compressed"
        return f"{self.name}/{kind}"

    @property
    def dtypes(self) -> tuple[np.dtype[Any], ...]:
        """Types that its array may have."""
        return (self.dtype,) if self.wide_dtype is None else (self.dtype, self.wide_dtype)

    def encoding_of(self, dtype: np.dtype[Any]) -> str:
        """Return the encoding on a ROS topic of an array of one of `dtypes`."""
        return self.wide_encoding if dtype == self.wide_dtype else self.encoding

    @property
    def is_label(self) -> bool:
        """True if values are ids or truth values: between two of them there is nothing."""
        return self.display in ("category", "instance", "mask")

    def shape(self, height: int, width: int) -> tuple[int, ...]:
        """Return the shape of this view's array for a picture of that size."""
        return (height, width) if self.channels == 1 else (height, width, self.channels)
