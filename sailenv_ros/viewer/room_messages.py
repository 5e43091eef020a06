"""Answers to commands about the room, as the page gets them: its plan, kinds, a new one."""

from __future__ import annotations

from typing_extensions import TypedDict

from sailenv_ros.viewer.scene_messages import Vector3

__all__ = [
    "FloorPlanValues",
    "PlannedObject",
    "PlannedOpening",
    "RoomKind",
    "RoomMade",
    "RoomSet",
]


class PlannedOpening(TypedDict):
    """A window or a door in a floor plan: middle along its wall, and width [m]."""

    type: str
    wall: str
    at: float
    width: float


class PlannedObject(TypedDict):
    """An object in a floor plan: the corners of its box seen from above [m]."""

    id: int
    name: str
    corners: list[tuple[float, float]]


class FloorPlanValues(TypedDict):
    """The room and what stands in it, seen from above [m]; the size is null for no room."""

    size: Vector3 | None
    openings: list[PlannedOpening]
    objects: list[PlannedObject]


class RoomSet(TypedDict):
    """The names of the objects whose places a new room has taken."""

    replaced: list[str]


class RoomKind(TypedDict):
    """A kind of room that can be generated."""

    kind: str
    title: str


class RoomMade(TypedDict):
    """The name by which a generated room is begun again."""

    scene: str
