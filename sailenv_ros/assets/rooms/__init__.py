"""Rooms: walls with openings, floors, ceilings, skirting, windows and doors, made by code."""

from sailenv_ros.assets.rooms.room import RoomPart, room_parts

__all__ = ["RoomPart", "room_parts"]
