"""Frames of a room's walls and partitions: where each begins and which way it faces."""

from __future__ import annotations

from dataclasses import replace

from sailenv_ros.assets.rooms.pieces import WallFrame
from sailenv_ros.scene.spec_room import (
    PartitionSpec,
    RoomSpec,
    WallName,
)

__all__ = ["Vector3", "behind", "partition_frame", "wall_frame"]


Vector3 = tuple[float, float, float]

_OUTWARD: dict[str, Vector3] = {
    "north": (0.0, 1.0, 0.0),
    "east": (1.0, 0.0, 0.0),
    "south": (0.0, -1.0, 0.0),
    "west": (-1.0, 0.0, 0.0),
}


def partition_frame(
    partition: PartitionSpec, height_m: float
) -> tuple[WallFrame, tuple[WallName, WallName]]:
    """Return a wall as its side to the south or west has it, and where its sides look."""
    (x0, y0), (x1, y1) = partition.start, partition.end
    along_x = abs(x1 - x0) > abs(y1 - y0)
    half = partition.thickness / 2.0
    x, y = (x0 + x1) / 2.0, (y0 + y1) / 2.0
    frame = WallFrame(
        along=(1.0, 0.0, 0.0) if along_x else (0.0, 1.0, 0.0),
        outward=(0.0, 1.0, 0.0) if along_x else (1.0, 0.0, 0.0),
        middle_m=(x, y - half, 0.0) if along_x else (x - half, y, 0.0),
        length_m=abs(x1 - x0) if along_x else abs(y1 - y0),
        height_m=height_m,
        thickness_m=partition.thickness,
        overhang_m=0.0,
    )
    return frame, ("south", "north") if along_x else ("west", "east")


def behind(frame: WallFrame) -> WallFrame:
    """Return a wall as its other side has it."""
    ox, oy, _ = frame.outward
    x, y, _ = frame.middle_m
    thick = frame.thickness_m
    return replace(frame, outward=(-ox, -oy, 0.0), middle_m=(x + thick * ox, y + thick * oy, 0.0))


def wall_frame(spec: RoomSpec, wall: WallName) -> WallFrame:
    """Return the frame of an outer wall, seen from inside."""
    size_x, size_y, height = spec.size
    lies_along_x = wall in ("north", "south")
    ox, oy, _ = _OUTWARD[wall]
    return WallFrame(
        along=(1.0, 0.0, 0.0) if lies_along_x else (0.0, 1.0, 0.0),
        outward=_OUTWARD[wall],
        middle_m=(ox * size_x / 2.0, oy * size_y / 2.0, 0.0),
        length_m=size_x if lies_along_x else size_y,
        height_m=height,
        thickness_m=spec.thickness,
        # The walls to north and south run on behind the ends of the two others.
        overhang_m=spec.thickness if lies_along_x else 0.0,
    )
