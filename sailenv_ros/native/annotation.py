"""The kernel of annotations: from depth and instance numbers to depth, instance and category."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens import LENS
from sailenv_ros.native.library import checked
from sailenv_ros.native.records import RecordKernel

__all__ = ["annotate_pixels"]

_KERNEL = RecordKernel(
    "annotate",
    height="integer",
    width="integer",
    surface="array",
    category_of_instance="array",
    lens="array",
    depth="array",
    category="array",
    instance="array",
)
_OUTPUTS: dict[str, Any] = {"depth": np.float32, "category": np.uint8, "instance": np.uint16}


def annotate_pixels(
    surface: NDArray[np.float32],
    category_of_instance: NDArray[np.uint8],
    lens: NDArray[np.void],
    views: Mapping[str, NDArray[Any]],
    *,
    threads: int,
) -> None:
    """Fill in the views.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth along the optical axis [m], ``inf`` where nothing was hit, and the instance id;
        what is no id from 0 to 65535 counts as 0.
    category_of_instance : (65536,) uint8
    lens : (1,) lens.LENS
        Beyond its far plane nothing is seen; the depth of what is nearer than near is nan.
    views : mapping of str to array
        What to fill in: ``depth`` (H, W) float32, and any of ``category`` uint8 and ``instance``
        uint16.
    threads : int

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library.
    """
    height, width = surface.shape[:2]
    checked("surface", surface, np.float32, (height, width, 2))
    checked("category_of_instance", category_of_instance, np.uint8, (65536,))
    checked("lens", lens, LENS, (1,))
    for name, array in views.items():
        checked(name, array, _OUTPUTS[name], (height, width))
    _KERNEL(
        threads,
        height=height,
        width=width,
        surface=surface,
        category_of_instance=category_of_instance,
        lens=lens,
        depth=views["depth"],
        category=views.get("category"),
        instance=views.get("instance"),
    )
