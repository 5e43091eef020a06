"""The kernels of a frame's views: filled in, measured, and as SAILenv's client has them.

What they compute stands in `render.picture.annotate`, `frame.truth.visible_parts` and
`frame.pictures.frame_dict`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens import LENS
from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.records import RecordKernel

__all__ = ["annotate_pixels", "convert_views", "measure_instances"]

_ANNOTATE = RecordKernel(
    "annotate",
    ("integer", "height width"),
    ("array", "surface category_of_instance lens along depth range category instance"),
)
_OUTPUTS: dict[str, Any] = {
    "depth": np.float32,
    "range": np.float32,
    "category": np.uint8,
    "instance": np.uint16,
}
_MEASURE = Kernel("measure_instances", "iiaaaaaaa")
_IDS = 65536
_CLIENT = Kernel("client_views", "iiaannaaaiaa")


def annotate_pixels(
    surface: NDArray[np.float32],
    category_of_instance: NDArray[np.uint8],
    lens: NDArray[np.void],
    views: Mapping[str, NDArray[Any]],
    *,
    along: NDArray[np.float32] | None = None,
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
        uint16; with `along` also ``range`` float32, the distance along the ray.
    along : (H, W) float32 or None
        z of each pixel's unit ray, nan where there is none: the surface holds distances along the
        rays then, and the clip distances are along them.
    threads : int

    Raises
    ------
    InvalidRequest
        If an array has another type, shape or size than the others.
    NativeLibraryError
        If there is no library.
    """
    height, width = surface.shape[:2]
    checked("surface", surface, np.float32, (height, width, 2))
    checked("category_of_instance", category_of_instance, np.uint8, (65536,))
    checked("lens", lens, LENS, (1,))
    for name, array in views.items():
        checked(name, array, _OUTPUTS[name], (height, width))
    if along is not None:
        checked("along", along, np.float32, (height, width))
    _ANNOTATE(
        threads,
        height=height,
        width=width,
        surface=surface,
        category_of_instance=category_of_instance,
        lens=lens,
        along=along,
        depth=views["depth"],
        range=views.get("range"),
        category=views.get("category"),
        instance=views.get("instance"),
    )


def measure_instances(
    instance: NDArray[np.uint16], flow: NDArray[np.float32] | None
) -> tuple[NDArray[np.uint16], NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
    """Measure what is seen of each instance.

    Parameters
    ----------
    instance : (H, W) uint16
    flow : (H, W, 2) float32 or None
        [px/s]; what is NaN, or 1e7 px/s and more, is left out.

    Returns
    -------
    ids : (N,) uint16
        Ascending, without the background.
    pixels : (N,) int32
    boxes : (N, 4) int32
        Left, top, right, bottom [px], the last ones included.
    sums : (N, 3) int64
        Flow to the right and down in steps of 2**-20 px/s, and the number of pixels that have any;
        0 without flow.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        As `annotate_pixels`.
    """
    height, width = instance.shape
    checked("instance", instance, np.uint16, (height, width))
    if flow is not None:
        checked("flow", flow, np.float32, (height, width, 2))
    counts = np.zeros(_IDS, np.int32)
    boxes = np.empty((_IDS, 4), np.int32)
    sums = None if flow is None else np.empty((_IDS, 3), np.int64)
    seen, seen_count = np.empty(_IDS, np.uint16), np.zeros(1, np.int64)
    _MEASURE(height, width, instance, flow, counts, boxes, sums, seen, seen_count)
    ids = np.sort(seen[: seen_count[0]])
    ids = ids[ids != 0]
    added = np.zeros((len(ids), 3), np.int64) if sums is None else sums[ids]
    return ids, counts[ids], boxes[ids], added


def convert_views(
    views: Mapping[str, NDArray[Any]],
    *,
    near_m: float,
    range_m: float,
    colours: NDArray[np.uint32],
    threads: int,
) -> dict[str, NDArray[Any]]:
    """Convert those of three views that there are.

    Parameters
    ----------
    views : mapping of str to array
        ``depth`` (H, W) float32 [m], ``instance`` (H, W) uint16, ``flow``
        (H, W, 2) float32 [px/s]: what is NaN in it becomes 0, in its place. Others are left alone.
    near_m, range_m : float
        Depths that are shown as 255 and as 0 [m].
    colours : (N,) uint32
        Blue, green and red of each instance id, and a byte without meaning; larger ids have the
        last colour.
    threads : int

    Returns
    -------
    arrays : dict of str to array
        ``grey`` (H, W) uint8; ``object`` (H, W, 3) uint8 BGR; ``flow_valid`` (H, W) bool: fresh
        arrays.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        As `annotate_pixels`.
    """
    size = next((array.shape[:2] for array in views.values()), (0, 0))
    made: dict[str, NDArray[Any]] = {}
    pointers: list[NDArray[Any] | None] = []
    for name, dtype, channels, target, target_dtype, target_channels in (
        ("depth", np.float32, (), "grey", np.uint8, ()),
        ("instance", np.uint16, (), "object", np.uint8, (3,)),
        ("flow", np.float32, (2,), "flow_valid", np.bool_, ()),
    ):
        if name not in views:
            pointers += [None, None]
            continue
        pointers.append(checked(name, views[name], dtype, (*size, *channels)))
        made[target] = np.empty((*size, *target_channels), target_dtype)
        pointers.append(made[target])
    checked("colours", colours, np.uint32, (None,))
    depth, grey, ids, coloured, flow, valid = pointers
    _CLIENT(
        *(threads, size[0] * size[1], depth, grey),
        *(range_m, 255.0 / (range_m - near_m), ids, coloured, colours, len(colours), flow, valid),
    )
    return made
