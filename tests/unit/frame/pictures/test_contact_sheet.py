"""Contact sheets: every picture is on them, with its label."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.pictures.contact_sheet import GAP_PX, contact_sheet, save_contact_sheet


def plain(colour: tuple[int, int, int], width: int = 120, height: int = 90) -> np.ndarray:
    """Return a picture of one colour."""
    return np.full((height, width, 3), colour, np.uint8)


FOUR = {
    "rgb": plain((200, 0, 0)),
    "b": plain((0, 200, 0)),
    "c": plain((0, 0, 200)),
    "d": plain((9, 9, 9)),
}


def test_tiles_stand_row_by_row() -> None:
    """Each picture's own pixels stand at its place, below its label."""
    sheet = contact_sheet(FOUR, columns=3)
    assert sheet.shape == (2 * 90 + 3 * GAP_PX, 3 * 120 + 4 * GAP_PX, 3)
    for number, picture in enumerate(FOUR.values()):
        row, column = divmod(number, 3)
        bottom = GAP_PX + row * (90 + GAP_PX) + 80
        right = GAP_PX + column * (120 + GAP_PX) + 110
        assert sheet[bottom, right].tolist() == picture[0, 0].tolist()


def test_labels_can_be_read() -> None:
    """In the corner there is white writing on a dark ground, on any picture."""
    for ground in ((255, 255, 255), (0, 0, 0)):
        corner = contact_sheet({"depth": plain(ground)})[GAP_PX : GAP_PX + 14, GAP_PX : GAP_PX + 40]
        assert corner.max() == 255
        assert corner.min() <= 90
        assert 0.1 < (corner.mean(axis=-1) > 170).mean() < 0.7


def test_pictures_of_other_sizes_are_scaled() -> None:
    """Tiles have one width and keep their own proportions."""
    sheet = contact_sheet({"a": plain((1, 2, 3)), "b": plain((50, 60, 70), 240, 100)})
    assert sheet.shape == (90 + 2 * GAP_PX, 2 * 120 + 3 * GAP_PX, 3)
    assert sheet[GAP_PX + 45, -GAP_PX - 5].tolist() == [50, 60, 70]
    assert sheet[GAP_PX + 60, -GAP_PX - 5].tolist() == [24, 24, 28]


def test_a_sheet_is_written_as_png(tmp_path: Path) -> None:
    """The file holds the sheet, pixel for pixel."""
    path = save_contact_sheet(tmp_path / "sheet.png", FOUR, columns=2)
    assert np.array_equal(np.asarray(Image.open(path)), contact_sheet(FOUR, columns=2))


def test_what_is_no_picture_is_refused(tmp_path: Path) -> None:
    """Nothing at all, arrays of another kind, and other file types each get a sentence."""
    with pytest.raises(InvalidRequest, match="at least one"):
        contact_sheet({})
    with pytest.raises(InvalidRequest, match="picture 'flow'"):
        contact_sheet({"flow": np.zeros((4, 4, 2), np.float32)})
    with pytest.raises(InvalidRequest, match=r"ends in \.png or \.jpg"):
        save_contact_sheet(tmp_path / "sheet.gif", FOUR)
