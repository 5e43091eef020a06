"""Views as colours: exact where arithmetic tells what they must be."""

from __future__ import annotations

import colorsys
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import UnknownName
from sailenv_ros.frame.pictures.colours import (
    colour_categories,
    colour_depth,
    colour_flow,
    encoded_colour,
    grey_depth,
    view_picture,
)
from sailenv_ros.types.bayer import BLACK_LEVEL, WHITE_LEVEL
from sailenv_ros.types.labels import Category, CategoryTable, colour_instances
from sailenv_ros.types.views import VIEWS

NAN, INF = math.nan, math.inf
TABLE = CategoryTable([Category(id=3, name="cube", colour=(9, 80, 255))])


@given(st.floats(-math.pi, math.pi), st.floats(0.0, 1.0))
def test_flow_is_hue_by_direction_and_value_by_speed(direction: float, speed: float) -> None:
    """The colour is that of the textbook HSV model at full saturation."""
    u, v = 50.0 * speed * math.cos(direction), 50.0 * speed * math.sin(direction)
    shown = colour_flow(np.array([[[u, v]]], np.float32), full_px_s=50.0)[0, 0]
    hue = (direction / (2.0 * math.pi)) % 1.0
    expected = 255.0 * np.array(colorsys.hsv_to_rgb(hue, 1.0, speed))
    assert np.abs(shown - expected).max() <= 0.51


def test_the_fastest_is_brightest_and_no_flow_is_black() -> None:
    """Without a given speed the picture's fastest has full value; NaN and rest are black."""
    flow = np.array([[[8.0, 0.0], [4.0, 0.0], [0.0, 0.0], [NAN, NAN]]], np.float32)
    assert colour_flow(flow).tolist() == [[[255, 0, 0], [128, 0, 0], [0, 0, 0], [0, 0, 0]]]
    assert colour_flow(np.zeros((2, 2, 2), np.float32)).max() == 0


def test_grey_depth_is_linear_and_nearer_is_lighter() -> None:
    """255 at the near plane, 0 from the range on; nothing hit is black, too near is white."""
    depth = np.array([[0.5, 1.5, 2.5, 4.0, INF, NAN, 0.1]], np.float32)
    assert grey_depth(depth, near_m=0.5, range_m=2.5).tolist() == [[255, 128, 0, 0, 0, 255, 255]]


@given(st.lists(st.floats(0.0, 1e4, width=32), min_size=2, max_size=20))
def test_depth_never_brightens_with_distance(depths: list[float]) -> None:
    """Farther is never lighter, neither in grey nor in the ramp's luminance."""
    ordered = np.sort(np.array([depths], np.float32))
    assert (np.diff(grey_depth(ordered).astype(int)) <= 0).all()
    luminance = colour_depth(ordered) @ np.array([0.30, 0.59, 0.11])
    assert (np.diff(luminance) <= 1.5).all()


def test_the_ramp_runs_from_white_to_black() -> None:
    """What is nearest is white and what is beyond the range black."""
    assert colour_depth(np.array([[0.0, INF]], np.float32)).tolist() == [[[255] * 3, [0] * 3]]


def test_categories_have_the_colours_of_the_table() -> None:
    """A category looks everywhere as its table says; ids without one are grey."""
    category = np.array([[0, 3, 77]], np.uint8)
    assert colour_categories(category, TABLE).tolist() == [[[0, 0, 0], [9, 80, 255], [128] * 3]]


@pytest.mark.parametrize("view", sorted(VIEWS))
def test_every_view_can_be_shown(view: str) -> None:
    """Whatever view there is, it becomes an RGB picture of its size, and a new array."""
    values = np.zeros(VIEWS[view].shape(4, 6), VIEWS[view].dtype)
    picture = view_picture(view, values, table=TABLE)
    assert (picture.shape, picture.dtype) == ((4, 6, 3), np.uint8)
    assert not np.shares_memory(picture, values)


def test_an_unknown_view_is_refused_with_the_known_ones() -> None:
    """It becomes no picture of another shape."""
    with pytest.raises(UnknownName, match="view must be one of: rgb, depth, category"):
        view_picture("heat", np.zeros((4, 6, 3), np.float32), table=TABLE)


def test_linear_colour_is_shown_by_its_srgb_codes() -> None:
    """Every code's light is shown as that code; values outside 0 to 1 by the nearest inside."""
    codes = np.arange(256)
    light = np.where(codes <= 10, codes / 255 / 12.92, ((codes / 255 + 0.055) / 1.055) ** 2.4)
    shown = encoded_colour(np.stack([light] * 3, axis=-1)[None].astype(np.float32))
    assert np.array_equal(shown[0, :, 1], codes)
    odd = np.array([[[-1.0, 7.0, NAN]]], np.float32)
    assert encoded_colour(odd).tolist() == [[[0, 255, 0]]]


def test_raw_data_are_shown_by_the_colours_of_their_cells() -> None:
    """Red and blue as they are, the mean green, in sRGB; also where the last cell is cut."""
    light = np.array([[1.0, 0.25], [0.75, 0.0]])
    levels = BLACK_LEVEL + (WHITE_LEVEL - BLACK_LEVEL) * light
    raw = np.tile(np.rint(levels).astype(np.uint16), (3, 4))[:5, :7]
    assert (view_picture("raw", raw, table=TABLE) == [255, 188, 0]).all()
    assert not view_picture("raw", raw // 16, table=TABLE).any()


def test_pictures_show_what_their_views_say() -> None:
    """Masks are black and white, normals centred on grey, instances in their own colours."""
    mask = np.array([[True, False]])
    assert view_picture("occlusion", mask, table=TABLE).tolist() == [[[255] * 3, [0] * 3]]
    normal = np.array([[[1.0, 0.0, -1.0]]], np.float32)
    assert view_picture("normals", normal, table=TABLE).tolist() == [[[255, 128, 0]]]
    ids = np.array([[0, 5]], np.uint16)
    assert np.array_equal(view_picture("instance", ids, table=TABLE), colour_instances(ids))
