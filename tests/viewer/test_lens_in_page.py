"""The page and a fisheye: its numbers, its image circle, and a track that is seen through it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playwright.sync_api import expect

from sailenv_ros.simulation import Simulation
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from tests.support.browser import OpenPage

pytestmark = pytest.mark.slow

FISHEYE = CameraIntrinsics(
    width=160, height=120, fx_px=36.0, fy_px=36.0, cx_offset_px=4.0, max_angle_deg=85.0,
    distortion_model="equidistant", distortion=(0.01, 0.0, 0.0, 0.0),
)  # fmt: skip

SCENE = """
version: 1
objects:
  - {name: floor, asset: cube, position: [0, 0, -0.5], scale: [12, 12, 1], static: true}
  - {name: post, asset: cube, position: [1.5, 1.5, 0.5], static: true}
lights: [{name: sun, type: directional, direction: [0.2, 0.1, -1.0]}]
agents:
  - {name: wide, width: 160, height: 120, fx: 36, fy: 36, cx_offset: 4, max_angle: 85,
     distortion_model: equidistant, distortion: [0.01, 0, 0, 0], following: false,
     position: [0, 0, 1.2]}
mover:
  total_time: 8
  loop: false
  waypoints: [{position: [1.0, 3.0, 1.2]}, {position: [0.5, -2.0, 0.6]}]
"""

TEAL = [14, 124, 116]
"""Colour of a waypoint."""

PAINTED = """colour => {
  const over = document.querySelector(".tile.main .over");
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [over.width, over.height];
  const pen = copy.getContext("2d", { willReadFrequently: true });
  pen.drawImage(over, 0, 0);
  const { data } = pen.getImageData(0, 0, copy.width, copy.height);
  const found = [over.width];
  for (let at = 0; at < data.length; at += 4) {
    if (data[at + 3] && (!colour || colour.every((value, band) => data[at + band] === value))) {
      found.push(at / 4);
    }
  }
  return found;
}"""
"""Width of what lies over the large picture, and numbers of the pixels painted in a colour."""


@pytest.fixture
def opened(opened: OpenPage) -> OpenPage:
    opened.page.locator("#agent").select_option(label="wide")
    expect(opened.page.locator("#lens")).to_contain_text("equidistant")
    return opened


def painted(opened: OpenPage, colour: list[int] | None = None) -> np.ndarray:
    """Places in the frame (N, 2) [px] of what lies over the large picture, in any colour."""
    width, *found = opened.page.evaluate(PAINTED, colour)
    rows, columns = np.divmod(np.array(found, np.int64), width)
    places: np.ndarray = (np.stack([columns, rows], axis=-1) + 0.5) * (FISHEYE.width / width) - 0.5
    return places


def test_the_lens_is_told(opened: OpenPage) -> None:
    """By its model, lengths, coefficients, and where it ends."""
    page = opened.page
    told = page.locator("#lens dd").all_text_contents()
    assert told[0] == "equidistant"
    assert told[1:3] == ["36.000, 36.000 px", "83.500, 59.500 px"]
    assert [float(text) for text in told[3:7]] == [0.01, 0.0, 0.0, 0.0]
    assert told[7:] == ["85.00° off the axis"]


def test_the_image_circle_is_drawn_where_the_picture_ends(opened: OpenPage) -> None:
    """All that is drawn lies on it, all around as far as the picture reaches."""
    opened.page.check("[data-draws=circle]")
    opened.until(lambda: len(painted(opened)), "the circle")
    angle = math.radians(85.0)
    radius = 36.0 * (angle + 0.01 * angle**3)
    away = painted(opened) - (FISHEYE.cx, FISHEYE.cy)
    assert np.abs(np.hypot(*away.T) - radius).max() < 2.5
    turns = np.degrees(np.arctan2(away[:, 1], away[:, 0]))
    assert len(np.unique(np.floor(turns / 10.0))) == 36
    opened.page.uncheck("[data-draws=circle]")
    opened.until(lambda: not len(painted(opened)), "it to go")


def test_waypoints_are_drawn_where_the_lens_sees_them(
    opened: OpenPage, simulation: Simulation
) -> None:
    """Through a pin-hole of these focal lengths they would be far beside these places."""
    opened.tab("Path")
    opened.until(lambda: len(painted(opened, TEAL)), "the waypoints")
    found = painted(opened, TEAL)
    pose: Pose = simulation.get_pose(agent="wide")
    assert pose.position_m == pytest.approx((0.0, 0.0, 1.2))
    # Right, down, ahead of a camera that looks along x.
    points = [(-3.0, 0.0, 1.0), (2.0, 0.6, 0.5)]
    expected = FISHEYE.project(points)
    spread = np.linalg.norm(found[:, None] - expected, axis=-1)
    nearest = spread.argmin(axis=1)
    assert spread.min(axis=1).max() < 6.0
    for number, pixel in enumerate(expected):
        assert found[nearest == number].mean(axis=0) == pytest.approx(pixel, abs=1.0)
    plain = CameraIntrinsics(width=160, height=120, fx_px=36.0, fy_px=36.0, cx_offset_px=4.0)
    assert np.linalg.norm(plain.project(points) - expected, axis=-1).min() > 30.0
