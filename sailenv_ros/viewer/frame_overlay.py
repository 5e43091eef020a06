"""Overlay of a frame on the page: boxes and outlines of objects, skeletons, a track, a circle.

`Frame` in, JSON out. Whatever lies in space comes into the picture here, through the frame's own
lens: the page draws pixels and knows no lens.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.lens_rays import tells_depth
from sailenv_ros.frame.truth.object_table import EDGES, ObjectTable
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.skeleton import COCO_KEYPOINTS, COCO_SKELETON
from sailenv_ros.viewer.encoding import outline
from sailenv_ros.viewer.messages import Overlay
from sailenv_ros.viewer.scene_messages import PersonLines, Segment

__all__ = ["image_circle", "overlay_of", "seen_points", "seen_segments"]

_LIMBS = [(first - 1, last - 1) for first, last in COCO_SKELETON]

PIECES = 16
"""Straight pieces that a line in space is drawn as where the lens bends it."""


def overlay_of(
    frame: Frame,
    *,
    boxes: bool = False,
    space: bool = False,
    whole: int = 0,
    track: Sequence[Pose] = (),
    loop: bool = False,
    circle: bool = False,
    people: bool = False,
) -> Overlay:
    """Return what is drawn over a frame.

    Parameters
    ----------
    frame : Frame
    boxes : bool
        Whether the boxes of what is visible are wanted.
    space : bool
        Whether the oriented boxes are.
    whole : int
        Instance whose amodal outline is wanted, 0 for none.
    track : sequence of Pose
        Waypoints that are wanted, with the lines between them.
    loop : bool
        Whether a line leads from the last one to the first.
    circle : bool
        Whether the border of what the lens sees is wanted.
    people : bool
        Whether the keypoints of people are wanted, with the lines between them.

    Returns
    -------
    overlay : Overlay
        Lines are told as far as the lens sees them.
    """
    told: Overlay = {
        "boxes": [],
        "edges": [],
        "whole": [],
        "waypoints": [],
        "track": [],
        "circle": image_circle(frame.camera.intrinsics) if circle else [],
        "people": _people(frame) if people else [],
    }
    if boxes or space:
        table = frame.objects.select(frame.objects.visible)
        if boxes:
            rows = np.concatenate([table.ids[:, None], table.visible_boxes], axis=1)
            told["boxes"] = rows.tolist()
        if space:
            told["edges"] = _edges(frame.camera, table)
    if whole:
        mask = frame.amodal_of(whole).mask(whole)
        told["whole"] = outline(mask.astype(np.uint16), 1)
    if track:
        points = np.array([pose.position_m for pose in track])
        pixels = np.round(seen_points(frame.camera, points), 1).tolist()
        told["waypoints"] = [
            (number, u, v) for number, (u, v) in enumerate(pixels, 1) if u == u and v == v
        ]
        starts = np.roll(points, 1, axis=0) if loop else points[:-1]
        lines = seen_segments(frame.camera, starts, points if loop else points[1:])
        told["track"] = [segment for line in lines for segment in line]
    return told


def seen_points(camera: Camera, points: ArrayLike) -> NDArray[np.float64]:
    """Return where points of the world are seen.

    Parameters
    ----------
    camera : Camera
    points : (..., 3) array-like
        World frame [m].

    Returns
    -------
    pixels : (..., 2) float64
        Columns and rows [px]; ``nan`` for points that the lens does not see, and for those nearer
        than the near plane.
    """
    matrix = camera.camera_from_world
    optical = np.asarray(points, np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    pixels = camera.intrinsics.project(optical)
    pixels[np.linalg.norm(optical, axis=-1) < camera.intrinsics.near_m] = np.nan
    return pixels


def seen_segments(camera: Camera, starts: ArrayLike, ends: ArrayLike) -> list[list[Segment]]:
    """Return how straight lines in space are seen.

    Parameters
    ----------
    camera : Camera
    starts, ends : (N, 3) array-like
        World frame [m].

    Returns
    -------
    lines : list of N lists
        Straight pieces u, v, u, v [px] of each line, without those of which an end is not seen: one
        where lines stay straight, up to `PIECES` through other lenses. None leads across the seam
        of a picture that goes all around.
    """
    lens = camera.intrinsics
    straight = tells_depth(lens)
    shares = np.linspace(0.0, 1.0, 2 if straight else PIECES + 1)[:, None]
    first, last = np.asarray(starts, np.float64), np.asarray(ends, np.float64)
    places = seen_points(camera, first[:, None] + shares * (last - first)[:, None])
    pieces = np.concatenate([places[:, :-1], places[:, 1:]], axis=-1)
    seen = np.isfinite(pieces).all(axis=-1)
    if not straight:
        seen &= np.abs(pieces[..., 2] - pieces[..., 0]) < 0.5 * lens.width
    return [
        [tuple(piece) for piece in line[kept].tolist()]
        for line, kept in zip(np.round(pieces, 1), seen, strict=True)
    ]


def image_circle(intrinsics: CameraIntrinsics) -> list[list[int]]:
    """Return the border of the pixels that see something: closed lines u, v, u, v, … [px].

    None where every pixel does.
    """
    valid = intrinsics.valid_pixels()
    return [] if valid.all() else outline(valid.astype(np.uint16), 1)


def _people(frame: Frame) -> list[PersonLines]:
    """Return the lines between the keypoints of each person, and those in view: u, v, seen."""
    found: list[PersonLines] = []
    for id_ in frame.states.skeletons if frame.states is not None else ():
        points = frame.keypoints(id_)
        if points.names != COCO_KEYPOINTS:
            continue  # of an animal
        first, last = (points.world[list(ends)] for ends in zip(*_LIMBS, strict=True))
        lines = [piece for line in seen_segments(frame.camera, first, last) for piece in line]
        places = np.round(points.pixels, 1).tolist()
        inside = points.hidden_by >= 0
        told = zip(places, points.visible.tolist(), inside.tolist(), strict=True)
        found.append((id_, lines, [(u, v, seen) for (u, v), seen, there in told if there]))
    return found


def _edges(camera: Camera, table: ObjectTable) -> list[tuple[int, list[Segment]]]:
    """Return the ids of objects, and the pieces of the twelve edges of each one's box."""
    ends = table.corners[:, np.array(EDGES)].reshape(-1, 2, 3)
    lines = iter(seen_segments(camera, ends[:, 0], ends[:, 1]))
    return [
        (number, [piece for _, line in zip(EDGES, lines, strict=False) for piece in line])
        for number in table.ids.tolist()
    ]
