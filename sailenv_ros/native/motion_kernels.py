"""The kernels of motion: where surface points are in another picture, and in other axes.

A surface point at X = Z (x, y, 1) of one camera's optical frame is at X + D X (D = T - 1,
homogeneous) in another one's, so it has moved in the picture by

    (f' - f) x + (cx' - cx) + f' (dX - x dZ) / (Z + dZ),   (dX, dY, dZ) = D X

and the same in y: exactly 0 where the lenses are equal and D is 0, with a rounding error that is
relative to the displacement. Points at infinity have X = (x, y, 1) without translation. Through
lenses that are no pin-hole the point is projected by their model, and does not move where D X is 0.
Where the transforms come from stands in `frame.motion.rigid_motion`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens import LENS
from sailenv_ros.native.lens_models import MOST_COEFFICIENTS
from sailenv_ros.native.library import checked
from sailenv_ros.native.records import Fields, RecordKernel

__all__ = [
    "MOTION_OUTPUTS",
    "BentLenses",
    "RowMotions",
    "SurfaceMotions",
    "move_points",
    "transform_points",
]

_PIXELS: tuple[Fields, ...] = (
    ("integer", "height width"),
    ("array", "depth instance row_of_instance"),
    ("integer", "rows"),
)
_MOVE = RecordKernel(
    "motion",
    *_PIXELS,
    ("array", "motions displacements from_lens to_lens"),
    ("integer", "bent"),
    ("array", "from_rays"),
    ("integer", "from_parallel to_model"),
    ("array", "to_coefficients"),
    ("number", "to_limit"),
    ("integer", "same_lens to_height to_width"),
    ("array", "to_depth to_instance"),
    ("number", "tolerance duration"),
    ("array", "own_from_rows rows_from_own at_rest"),
    ("integer", "row_poses"),
    ("array", "offsets deforming turns displacement_turns"),
    ("array", "flow scene_flow valid occluded out_of_view hidden"),
)
_TRANSFORM = RecordKernel(
    "transform_points",
    *_PIXELS,
    ("array", "transforms lens rays"),
    ("integer", "parallel"),
    ("array", "points"),
)


class BentLenses(NamedTuple):
    """Two lenses of which at least one is no pin-hole.

    Attributes
    ----------
    from_rays : (3, H, W) float32 or None
        Unit rays of the one picture's pixels, along which its depth is; nan where the lens sees
        nothing. None where depth is along the axis.
    from_parallel : bool
        Whether the rays of that picture are parallel.
    to_model : int
        `lens_models.LensModel.number` of the other lens; -1 for a pin-hole.
    to_coefficients : (MOST_COEFFICIENTS,) float64
    to_limit_rad : float
        Of its model.
    same : bool
        Whether both are one lens.
    """

    from_rays: NDArray[np.float32] | None
    from_parallel: bool
    to_model: int
    to_coefficients: NDArray[np.float64]
    to_limit_rad: float
    same: bool


class RowMotions(NamedTuple):
    """Poses by rows of two pictures, for groups of instances that move alike.

    Attributes
    ----------
    own_from_rows : (R, H, 4, 4) float64
        Axes of the group's own from the optical frame of each row of the one picture, transposed.
    rows_from_own : (R, H', 4, 4) float64
        The optical frame of each row of the other picture from the group's axes, transposed.
    at_rest : (R,) bool
        Groups that do not move at all, as the camera.
    """

    own_from_rows: NDArray[np.float64]
    rows_from_own: NDArray[np.float64]
    at_rest: NDArray[np.bool_]


class SurfaceMotions(NamedTuple):
    """How points of surfaces that deform have moved, besides the motion of their instances.

    Attributes
    ----------
    offsets : (H, W, 3) float32
        In the axes of the instance [m]; nan where it is not known. Read where a row deforms.
    deforming : (R,) bool
        Rows of the motions whose points have offsets.
    turns : (R, 3, 3) float64
        From the instance's axes at the other instant to those of the other camera.
    displacement_turns : (R, 3, 3) float64 or None
        From the same axes to those of the first camera.
    """

    offsets: NDArray[np.float32]
    deforming: NDArray[np.bool_]
    turns: NDArray[np.float64]
    displacement_turns: NDArray[np.float64] | None = None


MOTION_OUTPUTS: Mapping[str, tuple[Any, tuple[int, ...]]] = {
    "flow": (np.float32, (2,)),
    "scene_flow": (np.float32, (3,)),
    "valid": (np.bool_, ()),
    "occluded": (np.bool_, ()),
    "out_of_view": (np.bool_, ()),
    "hidden": (np.bool_, ()),
}
"""Type and channels of what `move_points` can find."""


def move_points(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    motions: NDArray[np.float64],
    displacements: NDArray[np.float64] | None,
    from_lens: NDArray[np.void],
    to_lens: NDArray[np.void],
    to_depth: NDArray[np.float32] | None,
    to_instance: NDArray[np.uint16] | None,
    tolerance: float,
    outputs: Mapping[str, NDArray[Any]],
    *,
    bent: BentLenses | None = None,
    by_rows: RowMotions | None = None,
    surfaces: SurfaceMotions | None = None,
    duration_s: float = 1.0,
    threads: int,
) -> None:
    """Find where the surface points of one picture are in another one.

    Parameters
    ----------
    depth, instance : (H, W) float32, uint16
        Views of the one picture: depth along the optical axis [m], ``inf`` where nothing was hit,
        ``nan`` where it is not known; instance ids.
    row_of_instance : (65536,) uint16
        Row of each instance in `motions` and `displacements`; 0 for what has no motion, or beyond.
    motions : (R, 3, 4) float64
        T - 1: where a point of the one camera's frame is in the other's, less the point.
    displacements : (R, 3, 4) float64 or None
        The same for the displacement that ``scene_flow`` tells of.
    from_lens, to_lens : (1,) lens.LENS
    to_depth, to_instance : (H', W') float32, uint16 or None
        The other picture's views. Without depth nothing is seen there; without ids depth alone
        decides, whatever it belongs to, and no far plane.
    tolerance : float
        Share of its depth by which a hidden point lies behind what is seen.
    outputs : mapping of str to array
        What to fill in, any of

        ``flow`` (H, W, 2) float32
            From the pixel to the point's place in the other picture over the duration [px/s];
            nan where it has none.
        ``scene_flow`` (H, W, 3) float32
            What the displacements say [m]; nan where there is no surface or no motion.
        ``valid`` (H, W) bool
            Where the point is in front of the other camera.
        ``occluded`` (H, W) bool
            Where it is within the other picture, which shows something else there.
        ``out_of_view`` (H, W) bool
            Where it is not within the other picture.
        ``hidden`` (H, W) bool
            Where the other picture does not show it, for whatever reason.
    bent : BentLenses or None
        Where a lens is no pin-hole. Its picture's depths are distances along the rays, unless these
        are parallel.
    by_rows : RowMotions or None
        Where a shutter rolls; counts instead of `motions`, with its groups as rows. Excludes
        ``scene_flow``.
    surfaces : SurfaceMotions or None
        Of what deforms, if something does.
    duration_s : float
        From the one picture to the other [s], negative if that is the earlier one; 1 gives flow
        in pixels.
    threads : int

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library.
    """
    pixels = _checked_pixels(depth, instance, row_of_instance, len(motions))
    checked("motions", motions, np.float64, (None, 3, 4))
    if displacements is not None:
        checked("displacements", displacements, np.float64, (len(motions), 3, 4))
    checked("from_lens", from_lens, LENS, (1,))
    checked("to_lens", to_lens, LENS, (1,))
    to_height = to_width = 0
    if to_depth is not None:
        checked("to_depth", to_depth, np.float32, (None, None))
        to_height, to_width = to_depth.shape
    if to_instance is not None:
        checked("to_instance", to_instance, np.uint16, (to_height, to_width))
    if bent is not None:
        checked("to_coefficients", bent.to_coefficients, np.float64, (MOST_COEFFICIENTS,))
        if bent.from_rays is not None:
            checked("from_rays", bent.from_rays, np.float32, (3, *depth.shape))
    for name, array in outputs.items():
        dtype, channels = MOTION_OUTPUTS[name]
        checked(name, array, dtype, (*depth.shape, *channels))
    if by_rows is not None:
        groups = len(motions)
        checked("own_from_rows", by_rows.own_from_rows, np.float64, (groups, len(depth), 4, 4))
        checked("rows_from_own", by_rows.rows_from_own, np.float64, (groups, None, 4, 4))
        checked("at_rest", by_rows.at_rest, np.bool_, (groups,))
    if surfaces is not None:
        count = len(motions)
        checked("offsets", surfaces.offsets, np.float32, (*depth.shape, 3))
        checked("deforming", surfaces.deforming, np.bool_, (count,))
        checked("turns", surfaces.turns, np.float64, (count, 3, 3))
        if surfaces.displacement_turns is not None:
            checked("turns", surfaces.displacement_turns, np.float64, (count, 3, 3))
    _MOVE(
        threads,
        **pixels,
        motions=motions,
        displacements=displacements,
        from_lens=from_lens,
        to_lens=to_lens,
        bent=bent is not None,
        from_rays=None if bent is None else bent.from_rays,
        from_parallel=bent is not None and bent.from_parallel,
        to_model=-1 if bent is None else bent.to_model,
        to_coefficients=None if bent is None else bent.to_coefficients,
        to_limit=0.0 if bent is None else bent.to_limit_rad,
        same_lens=bent is not None and bent.same,
        to_height=to_height,
        to_width=to_width,
        to_depth=to_depth,
        to_instance=to_instance,
        tolerance=tolerance,
        duration=duration_s,
        own_from_rows=None if by_rows is None else by_rows.own_from_rows,
        rows_from_own=None if by_rows is None else by_rows.rows_from_own,
        at_rest=None if by_rows is None else by_rows.at_rest,
        row_poses=0 if by_rows is None else by_rows.rows_from_own.shape[1],
        offsets=None if surfaces is None else surfaces.offsets,
        deforming=None if surfaces is None else surfaces.deforming,
        turns=None if surfaces is None else surfaces.turns,
        displacement_turns=None if surfaces is None else surfaces.displacement_turns,
        **{name: outputs.get(name) for name in MOTION_OUTPUTS},
    )


def transform_points(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    transforms: NDArray[np.float64],
    lens: NDArray[np.void],
    *,
    rays: NDArray[np.float64] | None = None,
    parallel: bool = False,
    threads: int,
) -> NDArray[np.float32]:
    """Return each pixel's surface point in other axes.

    Parameters
    ----------
    depth, instance, row_of_instance
        As `move_points` takes them.
    transforms : (R, 3, 4) float64
        Other axes from the camera's optical frame, for each instance.
    lens : (1,) lens.LENS
    rays : (3, H, W) float64 or None
        As `BentLenses.from_rays`.
    parallel : bool
        As `BentLenses.from_parallel`.
    threads : int

    Returns
    -------
    points : (H, W, 3) float32
        A fresh array; nan where there is no surface, or no row for it.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        As `move_points`.
    """
    pixels = _checked_pixels(depth, instance, row_of_instance, len(transforms))
    checked("transforms", transforms, np.float64, (None, 3, 4))
    checked("lens", lens, LENS, (1,))
    if rays is not None:
        checked("rays", rays, np.float64, (3, *depth.shape))
    points = np.empty((*depth.shape, 3), np.float32)
    _TRANSFORM(
        threads,
        **pixels,
        transforms=transforms,
        lens=lens,
        rays=rays,
        parallel=parallel,
        points=points,
    )
    return points


def _checked_pixels(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    rows: int,
) -> dict[str, Any]:
    """Return the fields `_PIXELS`."""
    height, width = depth.shape
    return {
        "height": height,
        "width": width,
        "depth": checked("depth", depth, np.float32, (height, width)),
        "instance": checked("instance", instance, np.uint16, (height, width)),
        "row_of_instance": checked("row_of_instance", row_of_instance, np.uint16, (65536,)),
        "rows": rows,
    }
