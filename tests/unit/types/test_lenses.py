"""Lenses that distort: OpenCV's laws, the way there and back, and where each of them ends."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.native.lens_models import lens_models
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.lens_law import LensLaw, law_of_lens
from sailenv_ros.types.picture_settings import PictureSettings

Doubles = NDArray[np.float64]

SMALL = st.floats(-0.01, 0.01)
MEDIUM = st.floats(-0.1, 0.1)
COEFFICIENTS: dict[str, st.SearchStrategy[tuple[float, ...]]] = {
    "pinhole": st.just(()),
    "plumb_bob": st.tuples(st.floats(-0.4, 0.4), MEDIUM, SMALL, SMALL, MEDIUM),
    "rational_polynomial": st.tuples(
        *(st.floats(-0.3, 0.3), MEDIUM, SMALL, SMALL, MEDIUM),
        *(st.floats(-0.3, 0.3), MEDIUM, MEDIUM, SMALL, SMALL, SMALL, SMALL),
    ),
    "equidistant": st.tuples(MEDIUM, SMALL, SMALL, SMALL),
    "double_sphere": st.tuples(st.floats(-0.9, 1.0), st.floats(0.0, 1.0)),
    "mei": st.tuples(st.floats(0.0, 2.5), st.floats(-0.3, 0.3), MEDIUM, SMALL, SMALL),
    "equirectangular": st.just(()),
}
"""Of models whose rays meet in one point."""

LAWS = st.sampled_from([*COEFFICIENTS]).flatmap(
    lambda name: COEFFICIENTS[name].map(lambda values: law_of_lens(name, values, 0.0))
)
SHARES = st.lists(
    st.tuples(st.floats(0.0, 0.97), st.floats(-math.pi, math.pi)), min_size=1, max_size=20
)
"""Directions: the share of the law's limit that is the angle from the axis, and where to."""

REAL = {
    "plumb_bob": (-0.2868, 0.0853, -0.0007, 0.0006, -0.0101),
    "rational_polynomial": (0.6, -0.03, 0.0004, -0.0006, 0.001, 0.95, 0.03, -0.004),
    "equidistant": (0.0034823894, 0.0007150348, -0.0020532361, 0.0002029367),
    "double_sphere": (-0.1717, 0.5933),
    "mei": (1.0437, -0.2041, 0.0451, 0.0004, -0.0003),
    "equirectangular": (),
}
"""Coefficients as calibrators find them; the rational one bends like a lens for phones."""


def _lens(model: str, **others: Any) -> CameraIntrinsics:
    numbers = {"width": 320, "height": 240, "fx_px": 250.0, "fy_px": 260.0, "cx_offset_px": 3.25}
    return CameraIntrinsics(
        **{**numbers, **others}, distortion_model=model, distortion=REAL.get(model, ())
    )


def _directions(law: LensLaw, shares: list[tuple[float, float]]) -> Doubles:
    rays = []
    for share, around in shares:
        angle = share * law.limit_rad
        across = math.sin(angle)
        rays.append((across * math.cos(around), across * math.sin(around), math.cos(angle)))
    return np.array(rays)


@given(LAWS, SHARES, st.floats(0.01, 100.0))
def test_a_ray_comes_back_from_its_place(
    law: LensLaw, shares: list[tuple[float, float]], distance: float
) -> None:
    """Up to 97 % of the angle at which the law ends, whatever the coefficients."""
    rays = _directions(law, shares)
    places = law.project(distance * rays)
    assert np.isfinite(places).all()
    np.testing.assert_allclose(law.unproject(places), rays, atol=1e-9)


PLACES = st.lists(st.tuples(st.floats(-4.0, 4.0), st.floats(-4.0, 4.0)), min_size=1, max_size=20)


@given(LAWS, PLACES, st.floats(0.05, 1.0))
def test_what_a_place_sees_is_seen_there(
    law: LensLaw, places: list[tuple[float, float]], share: float
) -> None:
    """Anywhere in the plane: a ray that is found is within the limit and leads to the place."""
    narrow = replace(law, limit_rad=share * law.limit_rad)
    rays = narrow.unproject(places)
    found = np.isfinite(rays).all(axis=1)
    assert np.isnan(rays[~found]).all()
    np.testing.assert_allclose(np.linalg.norm(rays[found], axis=1), 1.0, atol=1e-12)
    angles = np.arctan2(np.hypot(rays[found, 0], rays[found, 1]), rays[found, 2])
    assert (angles <= narrow.limit_rad * (1.0 + 1e-9)).all()
    back = law.project(rays[found])
    np.testing.assert_allclose(back, np.array(places)[found], rtol=1e-9, atol=1e-9)


@given(LAWS, SHARES)
def test_neighbours_stay_apart(law: LensLaw, shares: list[tuple[float, float]]) -> None:
    """The law turns nothing round within its limit: the derivative has a positive determinant."""
    step = 1e-5
    for ray in _directions(law, shares):
        right = np.cross((0.0, 1.0, 0.0), ray) if abs(ray[1]) < 0.9 else np.array((1.0, 0.0, 0.0))
        down = np.cross(ray, right)
        middle, one, other = law.project([ray, ray + step * right, ray + step * down])
        if law.model.name == "equirectangular" and abs(abs(middle[0]) - math.pi) < 0.01:
            continue  # the seam behind the camera
        (a, b), (c, d) = (one - middle) / step, (other - middle) / step
        assert a * d - b * c > 0.0


@given(
    st.one_of(
        st.tuples(st.just("plumb_bob"), COEFFICIENTS["plumb_bob"]),
        st.tuples(st.just("rational_polynomial"), COEFFICIENTS["rational_polynomial"]),
    ),
    SHARES,
)
def test_opencv_projects_to_the_same_pixels(
    chosen: tuple[str, tuple[float, ...]], shares: list[tuple[float, float]]
) -> None:
    """`cv2.projectPoints`, to 1e-9 pixel where the picture has its pixels."""
    law = law_of_lens(*chosen, 0.0)
    narrow = replace(law, limit_rad=min(law.limit_rad, 0.9))
    points = 3.0 * _directions(narrow, shares)
    focal, centre = np.array((431.0, 517.0)), np.array((322.25, 236.5))
    matrix = np.array([[focal[0], 0, centre[0]], [0, focal[1], centre[1]], [0, 0, 1]])
    expected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array(chosen[1]))
    found = narrow.project(points) * focal + centre
    np.testing.assert_allclose(found, expected.reshape(-1, 2), rtol=1e-12, atol=1e-9)


@given(COEFFICIENTS["equidistant"], SHARES)
def test_opencv_s_fisheye_projects_to_the_same_pixels(
    values: tuple[float, ...], shares: list[tuple[float, float]]
) -> None:
    """`cv2.fisheye.projectPoints`, which knows what is in front of the camera alone."""
    law = law_of_lens("equidistant", values, 0.0)
    narrow = replace(law, limit_rad=min(law.limit_rad, 1.5))
    points = 3.0 * _directions(narrow, shares)
    focal, centre = np.array((431.0, 517.0)), np.array((322.25, 236.5))
    matrix = np.array([[focal[0], 0, centre[0]], [0, focal[1], centre[1]], [0, 0, 1]])
    expected, _ = cv2.fisheye.projectPoints(
        points.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), matrix, np.array(values)
    )
    found = narrow.project(points) * focal + centre
    np.testing.assert_allclose(found, expected.reshape(-1, 2), rtol=1e-12, atol=1e-9)


@given(COEFFICIENTS["mei"], SHARES)
def test_mei_has_the_law_of_opencv_s_omnidir(
    values: tuple[float, ...], shares: list[tuple[float, float]]
) -> None:
    """As `cv2.omnidir.projectPoints` writes it: onto the sphere, shifted, then distorted."""
    law = law_of_lens("mei", values, 0.0)
    points = 3.0 * _directions(law, shares)
    xi, k1, k2, p1, p2 = values
    on_sphere = points / np.linalg.norm(points, axis=1, keepdims=True)
    x, y = (on_sphere[:, :2] / (on_sphere[:, 2:] + xi)).T
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2
    expected = np.stack(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ],
        axis=-1,
    )
    np.testing.assert_allclose(law.project(points), expected, rtol=1e-11, atol=1e-11)


@given(COEFFICIENTS["double_sphere"], SHARES)
def test_double_sphere_has_the_law_of_its_paper(
    values: tuple[float, ...], shares: list[tuple[float, float]]
) -> None:
    """Equations 40 to 42 of Usenko et al. 2018."""
    xi, alpha = values
    law = law_of_lens("double_sphere", values, 0.0)
    x, y, z = (3.0 * _directions(law, shares)).T
    d1 = np.sqrt(x**2 + y**2 + z**2)
    d2 = np.sqrt(x**2 + y**2 + (xi * d1 + z) ** 2)
    below = alpha * d2 + (1 - alpha) * (xi * d1 + z)
    expected = np.stack([x / below, y / below], axis=-1)
    found = law.project(np.stack([x, y, z], axis=-1))
    np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)


def test_the_whole_sphere_is_longitude_and_latitude() -> None:
    """Twice as wide as high: the middle is ahead, the left and right ends are behind."""
    lens = CameraIntrinsics(
        width=400, height=200, vertical_fov_deg=180.0, distortion_model="equirectangular"
    )
    assert lens.fx == lens.fy == pytest.approx(200 / math.pi)
    places = lens.project([(0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 1), (1e-9, 0, -1)])
    expected = [(199.5, 99.5), (299.5, 99.5), (99.5, 99.5), (199.5, 149.5), (399.5, 99.5)]
    np.testing.assert_allclose(places, expected, atol=1e-6)
    assert lens.valid_pixels().all()
    assert (lens.unit_rays()[..., 2] < 0).sum() == 400 * 200 // 2
    # Of depth along the axis there is none behind the camera.
    assert np.isnan(lens.rays()[:, 0]).all()


def test_parallel_rays_have_a_scale_in_pixels_a_metre() -> None:
    """Points lie where they are, whatever their depth; what is behind is not seen."""
    lens = CameraIntrinsics(
        width=64, height=48, fx_px=20.0, fy_px=20.0, distortion_model="orthographic"
    )
    np.testing.assert_allclose(lens.project([0.5, -0.25, 7.0]), [31.5 + 10.0, 23.5 - 5.0])
    assert np.isnan(lens.project([0.5, -0.25, -7.0])).all()
    np.testing.assert_array_equal(lens.unit_rays()[3, 5], (0.0, 0.0, 1.0))
    depth = np.full((48, 64), 2.5, np.float32)
    depth[0, 0] = np.inf
    points = lens.unproject(depth)
    v, u = np.mgrid[0:48, 0:64]
    np.testing.assert_allclose(points[1:], np.dstack([(u - 31.5) / 20, (v - 23.5) / 20, depth])[1:])
    assert np.isnan(points[0, 0]).all()
    with pytest.raises(InvalidRequest, match=r"fx_px must be above 0 \[px/m\], since all rays"):
        CameraIntrinsics(distortion_model="orthographic")


@pytest.mark.parametrize("model", [*REAL])
def test_every_pixel_s_ray_leads_back_to_it(model: str) -> None:
    """All over the picture, to 1e-9 pixel, also with other sizes and samples."""
    lens = _lens(model)
    valid = lens.valid_pixels()
    assert valid.any()
    v, u = np.mgrid[0 : lens.height, 0 : lens.width]
    back = lens.project(lens.unit_rays())
    assert (np.isfinite(back[..., 0]) == valid).all()
    np.testing.assert_allclose(back[valid], np.stack([u, v], -1)[valid], atol=1e-9)
    lengths = np.linalg.norm(lens.unit_rays(), axis=-1)[valid]
    np.testing.assert_allclose(lengths, 1.0, atol=1e-12)


@pytest.mark.parametrize("model", [*REAL])
def test_other_pictures_of_a_lens_see_the_same(model: str) -> None:
    """Samples, half pixels, other sizes and mirrored ones: one ray is at one place."""
    lens = _lens(model)
    rays = lens.unit_rays_through([(100.0, 90.0), (150.25, 130.5), (200.0, 60.0)])
    places = lens.project(rays)
    camera = Camera(intrinsics=lens, picture=PictureSettings(supersampling=3))
    np.testing.assert_allclose(camera.of_samples().intrinsics.project(rays), 3 * places + 1)
    np.testing.assert_allclose(camera.of_half_pixels().intrinsics.project(rays), 2 * places + 1)
    mirrored = lens.mirrored().project(rays * (-1.0, 1.0, 1.0))
    np.testing.assert_allclose(mirrored, (lens.width - 1, 0) + places * (-1, 1), atol=1e-9)
    twice = lens.mirrored().mirrored()
    assert twice == lens


@pytest.mark.parametrize("model", ["plumb_bob", "equidistant", "double_sphere", "mei"])
@pytest.mark.parametrize("angle", [40.0, 80.0, 118.0])
def test_a_vertical_angle_of_view_is_what_the_picture_shows(model: str, angle: float) -> None:
    """Without focal lengths they follow: half of the angle is half a pixel above the first row."""
    coefficients = {"plumb_bob": (0.0, 0.02, 0.0, 0.0)}.get(model, REAL[model])
    lens = CameraIntrinsics(
        vertical_fov_deg=angle, distortion_model=model, distortion=coefficients[:5]
    )
    half = math.radians(angle) / 2
    np.testing.assert_allclose(
        lens.project((0.0, math.sin(half), math.cos(half)))[1], 479.5, atol=1e-6
    )
    given_focal = replace(lens, fx_px=lens.fx, fy_px=lens.fy)
    assert given_focal.vertical_fov_deg == pytest.approx(angle, abs=0.2)
    zoomed = given_focal.with_vertical_fov(30.0)
    assert zoomed.vertical_fov_deg == pytest.approx(30.0, abs=0.1)
    assert zoomed.fx_px > given_focal.fx_px


def test_pixels_need_not_be_square() -> None:
    """Of a pin-hole too; what it shows follows from its focal length."""
    lens = CameraIntrinsics(width=200, height=100, fx_px=80.0, fy_px=50.0, cx_offset_px=-10.0)
    assert lens.is_pinhole
    assert lens.vertical_fov_deg == pytest.approx(90.0)
    np.testing.assert_allclose(lens.K, [[80, 0, 89.5], [0, 50, 49.5], [0, 0, 1]])
    np.testing.assert_allclose(lens.project([0.5, -0.5, 1.0]), [129.5, 24.5])
    np.testing.assert_allclose(lens.project(lens.rays())[7, 9], [9, 7])
    halves = Camera(intrinsics=lens).of_half_pixels().intrinsics
    np.testing.assert_allclose(halves.project([0.5, -0.5, 1.0]), [260.0, 50.0])
    zoomed = lens.with_vertical_fov(60.0)
    assert zoomed.fx / zoomed.fy == pytest.approx(1.6)


def test_beyond_the_image_circle_nothing_is_seen() -> None:
    """Its angle decides, in the picture and in the world; nothing is clamped."""
    lens = _lens("equidistant", fx_px=100.0, fy_px=100.0, max_angle_deg=60.0, cx_offset_px=0.0)
    v, u = np.mgrid[0:240, 0:320]
    angles = np.linspace(0.0, math.radians(60.0), 100001)
    k1, k2, k3, k4 = REAL["equidistant"]
    radius = (
        100.0
        * angles[-1]
        * (
            1
            + k1 * angles[-1] ** 2
            + k2 * angles[-1] ** 4
            + k3 * angles[-1] ** 6
            + k4 * angles[-1] ** 8
        )
    )
    inside = np.hypot(u - lens.cx, v - lens.cy) <= radius
    np.testing.assert_array_equal(lens.valid_pixels(), inside)
    for degrees, seen in ((59.999, True), (60.001, False), (179.0, False)):
        a = math.radians(degrees)
        assert np.isfinite(lens.project((math.sin(a), 0.0, math.cos(a)))).all() == seen


def test_wide_lenses_see_behind_themselves() -> None:
    """220 degrees: a ray 110 degrees from the axis has its place, and no depth."""
    lens = CameraIntrinsics(
        width=500,
        height=500,
        vertical_fov_deg=220.0,
        distortion_model="equidistant",
        distortion=(0.0, 0.0, 0.0, 0.0),
    )
    a = math.radians(109.0)
    u, v = lens.project((0.0, math.sin(a), math.cos(a)))
    assert (u, v) == pytest.approx((249.5, 249.5 + 250.0 * 109 / 110))
    np.testing.assert_allclose(lens.unit_rays_through((u, v)), (0, math.sin(a), math.cos(a)))
    assert np.isnan(lens.rays_through((u, v))).all()
    assert np.isfinite(lens.border()).all()


@pytest.mark.parametrize(
    ("model", "coefficients", "degrees"),
    [
        # r (1 + k r²) folds where 3 k r² = -1.
        ("plumb_bob", (-0.3, 0.0, 0.0, 0.0), math.degrees(math.atan(math.sqrt(1 / 0.9)))),
        # a (1 + k a²) folds where 3 k a² = -1.
        ("equidistant", (-0.1, 0.0, 0.0, 0.0), math.degrees(math.sqrt(1 / 0.3))),
        # Without distortion a shift of more than 1 ends at the tangents of the sphere.
        ("mei", (2.0, 0.0, 0.0, 0.0, 0.0), 120.0),
        ("mei", (0.5, 0.0, 0.0, 0.0, 0.0), 120.0),
        # With alpha of 0.5 and xi of 0: half of what the unified model sees.
        ("double_sphere", (0.0, 0.5), 180.0),
        ("double_sphere", (0.0, 0.0), 90.0),
        # Of one sphere alone the second centre sees half of it.
        ("double_sphere", (-0.5, 0.0), 60.0),
        ("double_sphere", (0.5, 1.0), 120.0),
    ],
)
def test_a_law_ends_where_arithmetic_says(
    model: str, coefficients: tuple[float, ...], degrees: float
) -> None:
    """To a part in a thousand less, where the place would be infinite."""
    found = math.degrees(law_of_lens(model, coefficients, 0.0).limit_rad)
    assert (1 - 1.1e-3) * degrees <= found <= degrees + 1e-9


def test_what_folds_within_the_picture_is_refused_unless_the_circle_ends_before() -> None:
    """Beyond the fold there are no rays: the message says which circle would do."""
    folding = {
        "fx_px": 150.0,
        "fy_px": 150.0,
        "distortion_model": "plumb_bob",
        "distortion": (-0.3, 0.0, 0.0, 0.0, 0.0),
    }
    with pytest.raises(InvalidRequest) as caught:
        CameraIntrinsics(**folding)  # type: ignore[arg-type]  # mixed values
    assert str(caught.value) == (
        "distortion must be coefficients that do not fold within the picture, or max_angle_deg "
        "must be less than 46.5084 [deg], where these fold, got [-0.3, 0.0, 0.0, 0.0, 0.0]"
    )
    lens = CameraIntrinsics(**folding, max_angle_deg=46.0)  # type: ignore[arg-type]  # the same
    assert 0.05 < lens.valid_pixels().mean() < 0.95
    narrow = CameraIntrinsics(**{**folding, "fx_px": 700.0, "fy_px": 700.0})  # type: ignore[arg-type]  # the same
    assert narrow.valid_pixels().all()


BAD = [
    (
        {"distortion_model": "plumbbob"},
        "distortion_model must be one of: pinhole, plumb_bob, rational_polynomial, equidistant, "
        "double_sphere, mei, equirectangular, orthographic (did you mean 'plumb_bob'?)",
    ),
    (
        {"distortion_model": "plumb_bob", "distortion": (0.1, 0.2)},
        "distortion must be 4 or 5 finite numbers, the coefficients k1 k2 p1 p2 k3 of plumb_bob, "
        "got [0.1, 0.2]",
    ),
    (
        {"distortion_model": "equidistant", "distortion": (0.1, 0.2, math.nan, 0.0)},
        "distortion must be 4 finite numbers, the coefficients k1 k2 k3 k4 of equidistant",
    ),
    ({"distortion": (0.1,)}, "distortion must be empty, since pinhole has no coefficients"),
    ({"distortion_model": "mei", "distortion": 7}, "distortion must be 5 finite numbers"),
    (
        {"distortion_model": "double_sphere", "distortion": (0.1, 1.5)},
        "distortion must be coefficients of double_sphere with xi above -1 and at most 1, alpha "
        "from 0 to 1, got [0.1, 1.5]",
    ),
    (
        {
            "distortion_model": "plumb_bob",
            "distortion": (0.0, 0.0, 0.0, 0.0),
            "vertical_fov_deg": 175.0,
        },
        "vertical_fov_deg must be a number from 1 to 170 [deg], got 175.0",
    ),
    (
        {
            "distortion_model": "equidistant",
            "distortion": (-0.1, 0.0, 0.0, 0.0),
            "max_angle_deg": 110.0,
        },
        "max_angle_deg must be at most 104.6073 [deg], where the law of equidistant folds",
    ),
    ({"fx_px": 500.0}, "fy_px must be above 0 [px] where the other focal length is; or both 0"),
    ({"fx_px": -1.0}, "fx_px must be a number from 0 to 1000000 [px], got -1.0"),
]


@pytest.mark.parametrize(("arguments", "sentence"), BAD)
def test_what_is_no_lens_is_refused_in_words(arguments: dict[str, Any], sentence: str) -> None:
    """Unknown models, wrong numbers of coefficients, angles beyond the model's."""
    with pytest.raises(InvalidRequest) as caught:
        CameraIntrinsics(**arguments)
    assert str(caught.value).startswith(sentence)
    assert isinstance(caught.value, UnknownName) == ("plumbbob" in arguments.values())


@pytest.mark.parametrize("model", [*REAL, "orthographic", "pinhole"])
def test_arguments_make_the_lens_again(model: str) -> None:
    """Plain values, as files of data sets keep them; and by pickle, for other processes."""
    lens = _lens(model, max_angle_deg=0.0 if model == "orthographic" else 30.0)
    assert CameraIntrinsics(**lens.arguments()) == lens
    assert pickle.loads(pickle.dumps(lens)) == lens
    assert CameraIntrinsics(**{**lens.arguments(), "distortion": np.array(lens.distortion)}) == lens


def test_the_table_of_models_is_whole() -> None:
    """Each has as many names as coefficients, and each odd one among them."""
    for number, (name, model) in enumerate(lens_models().items()):
        assert (model.number, model.name) == (number, name)
        assert max(model.counts) == len(model.coefficients)
        assert model.odd <= {*model.coefficients}
    assert [*COEFFICIENTS, "orthographic"] == [*lens_models()]
