"""The pin-hole camera: pixel centres, projection there and back, the OpenGL matrix."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose

LENSES = st.builds(
    CameraIntrinsics,
    width=st.integers(8, 400),
    height=st.integers(8, 400),
    vertical_fov_deg=st.floats(5.0, 150.0),
)


def test_the_optical_axis_meets_the_middle_of_the_pixel_grid() -> None:
    """640 x 480: cx = 319.5, cy = 239.5; 60 degrees: f = 240 / tan 30."""
    lens = CameraIntrinsics(width=640, height=480, vertical_fov_deg=60.0)
    expected = [[240 / math.tan(math.pi / 6), 0, 319.5], [0, 240 / math.tan(math.pi / 6), 239.5]]
    np.testing.assert_allclose(lens.K[:2], expected)


@given(LENSES)
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
    ({"near_m": 0}, "near_m must be a number from 0.001 to 10000 [m], got 0"),
]


@pytest.mark.parametrize(("arguments", "sentence"), BAD)
def test_what_is_no_lens_is_refused_in_words(arguments: dict[str, object], sentence: str) -> None:
    """Sizes, angles and clip distances out of range."""
    with pytest.raises(InvalidRequest) as caught:
        CameraIntrinsics(**arguments)  # type: ignore[arg-type]  # wrong on purpose
    assert str(caught.value).startswith(sentence)
