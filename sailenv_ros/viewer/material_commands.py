"""What a client may ask for about materials: what objects and the room are made of, pictures.

Arguments as JSON has them in, requests to a `Simulation` out. Part of the table of `commands.py`.
"""

from __future__ import annotations

import base64
import binascii
from typing import Any

from sailenv_ros.assets.pictures import MAX_PICTURE_BYTES
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.viewer.command_context import CommandContext, CommandTable
from sailenv_ros.viewer.recorded_commands import edits_object
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.scene_json import object_to_json

__all__ = ["MATERIAL_COMMANDS"]

MATERIAL_COMMANDS = CommandTable()


@MATERIAL_COMMANDS.changes
@edits_object("the material of")
async def set_material(context: CommandContext, given: Arguments) -> Any:
    """Change what an object or a part of the room is made of, by the keys of a scene file."""
    number = given.integer("object")
    part = given.optional_text("part") or ""
    await context.run(Operations.set_material, number, part, **given.mapping("changes"))
    return object_to_json(await context.run(Operations.get_object, number))


@MATERIAL_COMMANDS.changes
async def send_picture(context: CommandContext, given: Arguments) -> Any:
    """Take a piece of a picture file; after the last one, return the name of the picture."""
    pieces = context.picture_pieces
    if given.flag("first"):
        pieces.clear()
    data = given.get("data")
    try:
        piece = base64.b64decode(data if isinstance(data, str) else "!", validate=True)
    except (binascii.Error, ValueError):
        raise InvalidRequest("data", str(data)[:40], "a piece of a file in base 64") from None
    if len(pieces) + len(piece) > MAX_PICTURE_BYTES:
        pieces.clear()
        accepted = f"at most {MAX_PICTURE_BYTES // 1_000_000} MB"
        raise InvalidRequest("size of the picture", len(piece), accepted)
    pieces += piece
    if not given.flag("last"):
        return None
    whole = bytes(pieces)
    pieces.clear()
    return await context.run(Operations.upload_picture, whole)
