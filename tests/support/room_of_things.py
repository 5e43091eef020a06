"""A closed room with boxes all around, at rest and moving, and what a renderer sees of it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.tiny_scenes import (
    FRAME_NS,
    Thing,
    box_mesh,
    checker,
    contents_of,
    model_of,
    moved,
    snapshot_of,
    wall_mesh,
)

SKIN: dict[str, Any] = {"base_colour_texture": checker(3)}
WALLS = 6

CAMERA_PATHS = {
    "still": Pose.from_rpy_deg((0.0, 0.1, 0.0), (2.0, 5.0, 10.0)),
    "turn": Pose.from_rpy_deg((0.0, 0.1, 0.0), (3.0, 7.0, 13.0)),
    "shift": Pose.from_rpy_deg((0.03, 0.06, 0.02), (2.0, 5.0, 10.0)),
}
"""Where a camera is a frame after ``still``, by how it moved."""


def room_of_things() -> list[Thing]:
    """A closed room of six walls, and boxes all around the middle."""
    wall = model_of(wall_mesh(12.0, 12.0), **SKIN)
    things = [
        Thing(wall, Pose.from_rpy_deg((3.0, 0.0, 0.0), (0.0, 0.0, 0.0))),
        Thing(wall, Pose.from_rpy_deg((-4.0, 0.0, 0.0), (0.0, 0.0, 180.0))),
        Thing(wall, Pose.from_rpy_deg((0.0, 3.5, 0.0), (0.0, 0.0, 90.0))),
        Thing(wall, Pose.from_rpy_deg((0.0, -2.5, 0.0), (0.0, 0.0, -90.0))),
        Thing(wall, Pose.from_rpy_deg((0.0, 0.0, -1.6), (0.0, 90.0, 0.0))),
        Thing(wall, Pose.from_rpy_deg((0.0, 0.0, 1.9), (0.0, -90.0, 0.0))),
    ]
    box = model_of(box_mesh(0.5), **SKIN)
    for number in range(16):
        turn = 0.39 * number
        place = (1.8 * np.cos(turn), 1.6 * np.sin(turn), 0.25 * (number % 5) - 0.6)
        things.append(Thing(box, Pose.from_rpy_deg(place, (7 * number, 11 * number, 13 * number))))
    return things


def room_that_moves(
    things_move: bool, *, walls: int = WALLS
) -> tuple[WorldSnapshot, WorldSnapshot]:
    """Return the room, the last of its walls and its boxes, and a frame later; walls rest."""
    things = room_of_things()[WALLS - walls :]
    contents = contents_of(things)
    poses = [thing.pose for thing in things]
    if things_move:
        poses[walls:] = [
            Pose.from_rpy_deg(np.add(pose.position_m, (0.02, -0.03, 0.01)), (9 * k, 12 * k, 14 * k))
            for k, pose in enumerate(poses[walls:])
        ]
    before = snapshot_of(things, contents=contents)
    return before, snapshot_of(moved(things, *poses), contents=contents, time_ns=FRAME_NS)


def seen(
    renderer: RenderBackend, scene: WorldSnapshot, camera: Camera, *views: str
) -> dict[str, NDArray[Any]]:
    """Views without a past."""
    return dict(renderer.render(RenderRequest(scene, camera, views)).views)
