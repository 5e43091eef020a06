"""The pin-hole camera: pixel centres, projection there and back, the OpenGL matrix."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.camera import INTRINSICS_LIMITS, Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.picture_settings import PictureSettings

SIZE_AND_ANGLE = {
    "width": st.integers(8, 400),
    "height": st.integers(8, 400),
    "vertical_fov_deg": st.floats(5.0, 150.0),
}
CENTRED = st.builds(CameraIntrinsics, **SIZE_AND_ANGLE)
LENSES = st.builds(
    CameraIntrinsics,
    **SIZE_AND_ANGLE,
    cx_offset_px=st.floats(-4.0, 4.0),
    cy_offset_px=st.floats(-4.0, 4.0),
)


def test_the_optical_axis_meets_the_middle_of_the_pixel_grid() -> None:
    """640 x 480: cx = 319.5, cy = 239.5; 60 degrees: f = 240 / tan 30."""
    lens = CameraIntrinsics(width=640, height=480, vertical_fov_deg=60.0)
    expected = [[240 / math.tan(math.pi / 6), 0, 319.5], [0, 240 / math.tan(math.pi / 6), 239.5]]
    np.testing.assert_allclose(lens.K[:2], expected)


@given(CENTRED)
def test_the_field_of_view_ends_at_the_outer_edges_of_the_pixels(lens: CameraIntrinsics) -> None:
    """Half the angle up leads to half a pixel above the first row's centre."""
    top = math.tan(math.radians(lens.vertical_fov_deg) / 2)
    u, v = lens.project([0.0, -top, 1.0])
    assert u == pytest.approx(lens.cx)
    assert v == pytest.approx(-0.5, abs=1e-6)


@given(LENSES, st.floats(0.06, 90.0))
def test_unprojection_undoes_projection(lens: CameraIntrinsics, depth: float) -> None:
    """Every pixel's point at a depth projects onto the pixel."""
    points = lens.unproject(np.full((lens.height, lens.width), depth, np.float32))
    v, u = np.mgrid[0 : lens.height, 0 : lens.width]
    np.testing.assert_allclose(lens.project(points), np.stack([u, v], axis=-1), atol=1e-6)


@given(LENSES, st.floats(0.0, 1e-12))
def test_no_pixel_sees_a_point_in_the_camera_s_plane(lens: CameraIntrinsics, depth: float) -> None:
    """However small its depth; a pixel's number would overflow."""
    assert np.isnan(lens.project([3.0, -2.0, depth])).all()


@given(LENSES)
def test_rays_are_those_of_the_whole_picture_in_any_part_of_it(lens: CameraIntrinsics) -> None:
    """By a window and by places of pixels: the same bits; between pixels they project back."""
    rays = lens.rays()
    rows, columns = slice(1, lens.height - 2), slice(2, lens.width)
    np.testing.assert_array_equal(lens.rays(rows, columns), rays[rows, columns])
    v, u = np.mgrid[0 : lens.height, 0 : lens.width]
    np.testing.assert_array_equal(lens.rays_through(np.stack([u, v], axis=-1)), rays)
    places = np.array([[0.25, -3.5], [lens.width + 7.5, 2.75]])
    np.testing.assert_allclose(lens.project(lens.rays_through(places)), places, atol=1e-6)


@given(LENSES)
def test_kernels_are_given_the_numbers_of_the_lens(lens: CameraIntrinsics) -> None:
    """Each under its name, read-only, and made once."""
    record = lens.lens_record
    for name in ("fx", "fy", "cx", "cy", "near_m", "far_m"):
        assert record[name][0] == getattr(lens, name)
    assert not record.flags.writeable
    assert lens.lens_record is record


@given(LENSES, st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(0.1, 50.0)))
def test_the_opengl_matrix_says_the_same_as_the_projection(lens: CameraIntrinsics, point) -> None:  # type: ignore[no-untyped-def]  # drawn tuple
    """Clip coordinates through the viewport give the same pixel; w is the depth."""
    clip = lens.clip_from_optical() @ [*point, 1.0]
    u = (clip[0] / clip[3] + 1) / 2 * lens.width - 0.5
    v = (1 - clip[1] / clip[3]) / 2 * lens.height - 0.5
    np.testing.assert_allclose([u, v], lens.project(point), atol=1e-6)
    assert clip[3] == point[2]


def test_an_axis_off_the_centre_moves_the_whole_picture() -> None:
    """By as much to the right and down; the focal length stays."""
    centred = CameraIntrinsics(width=100, height=80, vertical_fov_deg=60.0)
    off = replace(centred, cx_offset_px=12.5, cy_offset_px=-7.0)
    assert (off.fx, off.fy) == (centred.fx, centred.fy)
    assert (off.cx, off.cy) == (49.5 + 12.5, 39.5 - 7.0)
    x, y, z = 0.3, -0.4, 2.0
    f = 40.0 / math.tan(math.radians(30.0))
    np.testing.assert_allclose(off.project([x, y, z]), [62.0 + f * x / z, 32.5 + f * y / z])
    assert off.K[0, 2] == off.cx
    assert off.K[1, 2] == off.cy
    (left, top), (right, bottom) = off.border()
    np.testing.assert_allclose([left, right], [-62.5 / f, 37.5 / f])
    np.testing.assert_allclose([top, bottom], [-33.0 / f, 47.0 / f])


def test_samples_of_a_long_lens_have_a_focal_length_in_range() -> None:
    """Refused as the camera is made, not while it draws."""
    lens = CameraIntrinsics(width=64, height=48, fx_px=4e5, fy_px=4e5)
    assert Camera(intrinsics=lens, picture=PictureSettings(supersampling=2)).of_samples()
    with pytest.raises(InvalidRequest, match="at most 2 for fx_px = 400000"):
        Camera(intrinsics=lens, picture=PictureSettings(supersampling=3))


@given(LENSES, st.integers(2, 4))
def test_samples_lie_in_their_pixels(lens: CameraIntrinsics, times: int) -> None:
    """With supersampling and half a pixel apart: one ray is at one place of the picture."""
    rays = lens.rays_through([(0.0, 0.0), (lens.width - 1.0, lens.height - 1.0), (2.25, 3.5)])
    places = lens.project(rays)
    middle = 0.5 * (times - 1)
    camera = Camera(intrinsics=lens, picture=PictureSettings(supersampling=times))
    finer = camera.of_samples().intrinsics
    np.testing.assert_allclose(finer.project(rays), times * places + middle, atol=1e-5)
    halves = camera.of_half_pixels().intrinsics
    np.testing.assert_allclose(halves.project(rays), 2.0 * places + 1.0, atol=1e-5)


@given(LENSES)
def test_a_mirrored_picture_has_left_and_right_exchanged(lens: CameraIntrinsics) -> None:
    """A point with the other x is as far from the other side."""
    u, v = lens.project([0.3, 0.2, 1.5])
    mirrored = lens.mirrored().project([-0.3, 0.2, 1.5])
    np.testing.assert_allclose(mirrored, [lens.width - 1 - u, v], atol=1e-9)


@given(LENSES)
def test_numbers_make_the_lens_again(lens: CameraIntrinsics) -> None:
    """All of them in one order, but those that an axis in the centre does not need."""
    assert CameraIntrinsics(**lens.numbers()) == lens  # type: ignore[arg-type]  # sizes are whole
    downwards = replace(lens, cx_offset_px=0.0, cy_offset_px=1.0)
    assert [*downwards.numbers()] == [*INTRINSICS_LIMITS][:7]
    centred = replace(lens, cx_offset_px=0.0, cy_offset_px=0.0)
    assert [*centred.numbers()] == ["width", "height", "vertical_fov_deg", "near_m", "far_m"]


def test_near_and_far_are_the_ends_of_clip_space() -> None:
    """Depth near is -1, far is 1."""
    lens = CameraIntrinsics(near_m=0.2, far_m=30.0)
    for depth, expected in ((0.2, -1.0), (30.0, 1.0)):
        clip = lens.clip_from_optical() @ [0, 0, depth, 1]
        assert clip[2] / clip[3] == pytest.approx(expected)


def test_what_is_behind_has_no_pixel() -> None:
    """Points at or behind the camera project to NaN."""
    assert np.isnan(CameraIntrinsics().project([[0, 0, 0], [1, 1, -2]])).all()


def test_the_world_is_seen_along_the_body_s_x() -> None:
    """A point ahead of the body is on the optical axis, one to its left is left."""
    camera = Camera(pose=Pose.from_rpy_deg((1, 2, 3), (0, 0, 90)))
    ahead = camera.camera_from_world @ [1, 7, 3, 1]
    np.testing.assert_allclose(ahead, [0, 0, 5, 1], atol=1e-12)
    left = camera.camera_from_world @ [0, 7, 3, 1]
    np.testing.assert_allclose(left, [-1, 0, 5, 1], atol=1e-12)


BAD = [
    ({"width": 0}, "width must be an integer from 8 to 4096 [px], got 0"),
    ({"height": 100_000}, "height must be an integer from 8 to 4096 [px], got 100000"),
    ({"width": 64.0}, "width must be an integer from 8 to 4096 [px], got 64.0"),
    ({"width": True}, "width must be an integer from 8 to 4096 [px], got True"),
    ({"vertical_fov_deg": 180}, "vertical_fov_deg must be a number from 1 to 170 [deg], got 180"),
    ({"vertical_fov_deg": math.nan}, "vertical_fov_deg must be a number from 1 to 170 [deg]"),
    ({"near_m": 5.0, "far_m": 5.0}, "near_m must be less than far_m = 5 [m], got 5.0"),
    (
        {"width": 64, "cx_offset_px": 32.5},
        "cx_offset_px must be within half the picture, 32 [px], got 32.5",
    ),
    (
        {"height": 48, "cy_offset_px": -25},
        "cy_offset_px must be within half the picture, 24 [px], got -25",
    ),
    ({"cx_offset_px": math.inf}, "cx_offset_px must be a number from -2048 to 2048 [px], got inf"),
    ({"near_m": 0}, "near_m must be a number from 0.001 to 10000 [m], got 0"),
]


@pytest.mark.parametrize(("arguments", "sentence"), BAD)
def test_what_is_no_lens_is_refused_in_words(arguments: dict[str, object], sentence: str) -> None:
    """Sizes, angles and clip distances out of range."""
    with pytest.raises(InvalidRequest) as caught:
        CameraIntrinsics(**arguments)  # type: ignore[arg-type]  # wrong on purpose
    assert str(caught.value).startswith(sentence)
