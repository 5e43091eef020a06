"""Pictures of assets and scenes show what they are asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.cli.main import main
from sailenv_ros.simulation.models.preview_renderer import FLOOR_COLOUR, PreviewRenderer


def test_a_thumbnail_fills_the_picture_whatever_the_size() -> None:
    """A ball is in the middle, with floor around it; the size of an asset does not matter."""
    assert len(FLOOR_COLOUR) == 3
    with PreviewRenderer() as previews:
        picture = previews.thumbnail(Primitives().load("sphere"), width=160, height=120)
        assert picture.shape == (120, 160, 3)
        assert picture.dtype == np.uint8
        again = previews.thumbnail(Primitives().load("sphere"), width=160, height=120)
    np.testing.assert_array_equal(picture, again)
    centre, corner = picture[50:60, 75:85].astype(int), picture[-8:, -8:].astype(int)
    assert abs(centre.mean() - corner.mean()) > 10


def test_a_scene_is_rendered_with_its_five_views(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The sheet has a tile for each view, of the size that was asked for."""
    out = tmp_path / "views.png"
    size = ["--width", "64", "--height", "48", "--columns", "5"]
    assert main(["scene", "render", "optical", "-o", str(out), *size, "--time", "1"]) == 0
    assert str(out) in capsys.readouterr().out
    with Image.open(out) as sheet:
        assert sheet.size == (5 * 64 + 6 * 6, 48 + 2 * 6)


def test_a_viewpoint_can_be_given(tmp_path: Path) -> None:
    """Looking up into the sky shows no instance."""
    out = tmp_path / "sky.png"
    place = ["--position", "0", "0", "9", "--look-at", "0", "1", "90", "--views", "instance"]
    assert main(["scene", "render", "optical", "-o", str(out), *place]) == 0
    with Image.open(out) as sheet:
        assert np.asarray(sheet)[100:400, 100:500].std() == 0.0


def test_a_scene_may_have_an_agent_of_any_name(tmp_path: Path) -> None:
    """`random_shapes` has an agent `eye`."""
    out = tmp_path / "shapes.png"
    size = ["--width", "64", "--height", "48", "--views", "rgb", "--plain"]
    assert main(["scene", "render", "random_shapes", "-o", str(out), *size]) == 0
    assert out.is_file()


def test_a_view_alone_has_no_border(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file has the view's size; of several views there is no such file."""
    out = tmp_path / "plain.png"
    plain = ["scene", "render", "optical", "-o", str(out), "--plain"]
    size = ["--width", "64", "--height", "48"]
    assert main([*plain, *size]) == 2
    assert "--views NAME" in capsys.readouterr().err
    assert not out.exists()
    assert main([*plain, *size, "--views", "category"]) == 0
    with Image.open(out) as picture:
        assert picture.size == (64, 48)
        assert np.asarray(picture)[0, 0].tolist() != [24, 24, 28]
