"""Pictures as files: one alone, or several on one sheet, each with its label."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.files import storage_errors, write_file

__all__ = ["contact_sheet", "save_contact_sheet", "save_picture"]

GAP_PX = 6
PAPER = (24, 24, 28)
LABEL_BACK = (0, 0, 0, 170)
LABEL_INK = (255, 255, 255, 255)


def contact_sheet(
    pictures: Mapping[str, NDArray[np.uint8]], *, columns: int = 3, tile_width: int | None = None
) -> NDArray[np.uint8]:
    """Lay pictures out in rows, each with its label in the corner.

    Parameters
    ----------
    pictures : mapping of str to (H, W, 3) uint8
        RGB, of any sizes; in order, row by row.
    columns : int
        Tiles in a row.
    tile_width : int or None
        Width that each picture is scaled to [px]; None means the first picture's own.

    Returns
    -------
    sheet : (H, W, 3) uint8
        RGB.

    Raises
    ------
    InvalidRequest
        If there is no picture, or something that is none.
    """
    if not pictures:
        raise InvalidRequest("pictures", 0, "at least one")
    for label, picture in pictures.items():
        if picture.dtype != np.uint8 or picture.ndim != 3 or picture.shape[2] != 3:
            got = f"{picture.shape} of {picture.dtype}"
            raise InvalidRequest(f"picture {label!r}", got, "(H, W, 3) of uint8")
    width = next(iter(pictures.values())).shape[1] if tile_width is None else tile_width
    tiles = [_tile(label, picture, width) for label, picture in pictures.items()]
    across = min(columns, len(tiles))
    height = max(tile.height for tile in tiles)
    down = math.ceil(len(tiles) / across)
    size = (across * (width + GAP_PX) + GAP_PX, down * (height + GAP_PX) + GAP_PX)
    sheet = Image.new("RGB", size, PAPER)
    for number, tile in enumerate(tiles):
        row, column = divmod(number, across)
        place = (GAP_PX + column * (width + GAP_PX), GAP_PX + row * (height + GAP_PX))
        sheet.paste(tile, place)
    return np.asarray(sheet).copy()


def save_contact_sheet(
    path: str | Path,
    pictures: Mapping[str, NDArray[np.uint8]],
    *,
    columns: int = 3,
    tile_width: int | None = None,
) -> Path:
    """Write a `contact_sheet` as a PNG or JPEG file; return its path.

    Raises
    ------
    InvalidRequest
        If a picture is none, or the file's name ends in neither ``.png`` nor ``.jpg``.
    """
    file = _picture_file(path, "path of the contact sheet")
    return save_picture(file, contact_sheet(pictures, columns=columns, tile_width=tile_width))


def save_picture(path: str | Path, picture: NDArray[np.uint8]) -> Path:
    """Write (H, W, 3) RGB pixels as they are, as a PNG or JPEG file; return its path.

    Raises
    ------
    InvalidRequest
        If the file's name ends in neither ``.png`` nor ``.jpg``.
    StorageError
        If it cannot be written.
    """
    file = _picture_file(path, "path of the picture")
    data = io.BytesIO()
    kind = "PNG" if file.suffix.lower() == ".png" else "JPEG"
    Image.fromarray(picture).save(data, kind, optimize=True, quality=88)
    with storage_errors("the picture", file):
        write_file(file, data.getvalue())
    return file


def _picture_file(path: str | Path, what: str) -> Path:
    file = Path(path)
    if file.suffix.lower() not in (".png", ".jpg"):
        raise InvalidRequest(what, str(path), "a name that ends in .png or .jpg")
    return file


def _tile(label: str, picture: NDArray[np.uint8], width: int) -> Image.Image:
    tile = Image.fromarray(picture)
    if tile.width != width:
        height = max(1, round(tile.height * width / tile.width))
        tile = tile.resize((width, height), Image.Resampling.LANCZOS)
    font = ImageFont.load_default(size=max(11, width // 20))
    pen = ImageDraw.Draw(tile, "RGBA")
    left, top, right, bottom = pen.textbbox((0, 0), label, font=font)
    pad = max(3, width // 90)
    pen.rectangle((0, 0, right - left + 2 * pad, bottom - top + 2 * pad), fill=LABEL_BACK)
    pen.text((pad - left, pad - top), label, font=font, fill=LABEL_INK)
    return tile
