"""The kernels in C++ compute the bytes of their definition in plain NumPy.

On every instruction set that this machine has, and on any number of threads.
"""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
import pytest

from sailenv_ros.frame.pictures import frame_dict
from sailenv_ros.frame.pictures.colours import grey_depth
from sailenv_ros.native import lens_light, picture_kernels, view_kernels
from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.render.picture.ambient_occlusion import PATTERN, kernel_settings
from sailenv_ros.render.picture.tone import code_table
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.labels import instance_colours
from sailenv_ros.types.picture_settings import PictureSettings
from tests.support import reference_kernels as reference

SIZES = [(8, 8), (9, 13), (61, 97), (48, 160), (130, 200)]
THREADS = (1, 2, 5)

Arrays = dict[str, np.ndarray]


@pytest.fixture(params=load_library().instruction_sets)
def instruction_set(request: pytest.FixtureRequest) -> Iterator[str]:
    """Let kernels run on one of the instruction sets."""
    with using_instruction_set(request.param):
        yield request.param


def blocky_surface(rng: np.random.Generator, height: int, width: int) -> np.ndarray:
    """Patches of some ids at slanted depths, with sky, single pixels and what is too near."""
    down, along = -(-height // 7), -(-width // 11)
    ids = np.repeat(np.repeat(rng.integers(0, 40, (down, along)), 7, 0), 11, 1)[:height, :width]
    single = rng.random((height, width)) < 0.05
    ids[single] = rng.integers(0, 60000, int(single.sum()))
    depth = 0.5 + 0.15 * ids % 4 + 0.01 * np.arange(width) + rng.random((height, 1))
    depth[rng.random((height, width)) < 0.02] = 0.01
    depth[rng.random((height, width)) < 0.02] = 70.0
    sky = ids == 0
    depth[sky] = np.inf
    return np.stack([depth, ids], axis=-1).astype(np.float32)


def empty_views(height: int, width: int) -> Arrays:
    return {
        "depth": np.empty((height, width), np.float32),
        "category": np.empty((height, width), np.uint8),
        "instance": np.empty((height, width), np.uint16),
    }


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.usefixtures("instruction_set")
def test_annotations_are_those_of_the_definition(size: tuple[int, int]) -> None:
    """All views, bit by bit; and each of them alone."""
    rng = np.random.default_rng(size)
    lens = CameraIntrinsics(near_m=0.05, far_m=60.0).lens_record
    categories = rng.integers(0, 256, 65536).astype(np.uint8)
    given = (blocky_surface(rng, *size), categories, lens)
    expected = empty_views(*size)
    reference.annotate_pixels(*given, expected, threads=1)
    if size[0] > 60:
        # Everything happens in this picture.
        assert np.isnan(expected["depth"]).any()
        assert np.isinf(expected["depth"]).any()
    for threads in THREADS:
        got = empty_views(*size)
        view_kernels.annotate_pixels(*given, got, threads=threads)
        for name, array in got.items():
            assert array.tobytes() == expected[name].tobytes(), name
    for name in expected:
        some = {key: array for key, array in empty_views(*size).items() if key in ("depth", name)}
        view_kernels.annotate_pixels(*given, some, threads=2)
        assert some[name].tobytes() == expected[name].tobytes(), name


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("share_baked", [0.0, 0.7, 1.0])
@pytest.mark.usefixtures("instruction_set")
def test_ambient_visibility_is_that_of_the_definition(
    size: tuple[int, int], share_baked: float
) -> None:
    """Where the light of some of the surfaces is known, of all and of none."""
    rng = np.random.default_rng(size)
    surface = blocky_surface(rng, *size)
    known = (rng.random(65536) < share_baked).astype(np.uint8)
    intrinsics = CameraIntrinsics(width=size[1], height=size[0])
    given = (intrinsics.lens_record, kernel_settings(intrinsics, 0.8, 0.6), PATTERN)
    visibility, inverse = reference.find_ambient_visibility(surface, known, *given, threads=1)
    if share_baked == 0.0 and size[0] > 40:
        assert visibility.min() < 200
    for threads in THREADS:
        got = picture_kernels.find_ambient_visibility(surface, known, *given, threads=threads)
        np.testing.assert_array_equal(got[0], visibility)
        np.testing.assert_array_equal(got[1], inverse)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("shaded", [False, True])
@pytest.mark.usefixtures("instruction_set")
def test_pictures_are_those_of_the_definition(size: tuple[int, int], shaded: bool) -> None:
    """The tone curve, with and without ambient visibility."""
    rng = np.random.default_rng(size)
    surface = blocky_surface(rng, *size)
    radiance = picture_radiance(rng, surface)
    table = code_table(PictureSettings())
    intrinsics = CameraIntrinsics(width=size[1], height=size[0])
    settings = kernel_settings(intrinsics, 1.0, 0.6)
    shade = reference.find_ambient_visibility(
        *(surface, np.zeros(65536, np.uint8), intrinsics.lens_record, settings, PATTERN), threads=1
    )
    given = (radiance, table, *(shade if shaded else (None, None)), surface)
    expected = reference.make_picture(*given, same_surface=0.04, threads=1)
    for threads in THREADS:
        got = picture_kernels.make_picture(*given, same_surface=0.04, threads=threads)
        np.testing.assert_array_equal(got, expected)


@pytest.mark.parametrize("times", [1, 2, 3, 4])
@pytest.mark.parametrize("shaded", [False, True])
@pytest.mark.usefixtures("instruction_set")
def test_samples_are_resolved_as_the_definition_does(times: int, shaded: bool) -> None:
    """Sizes that are odd, too."""
    rng = np.random.default_rng(times)
    height, width = 31, 45
    surface = blocky_surface(rng, times * height, times * width)
    samples = picture_radiance(rng, surface)
    shade = (
        rng.integers(0, 256, (16, 23)).astype(np.uint8),
        (1.0 / surface[:: 2 * times, :: 2 * times, 0]).astype(np.float32),
    )
    given = (samples, times, *(shade if shaded else (None, None)), surface)
    for keep in (False, True) if times == 1 else (False,):
        words = {"same_surface": 0.04, "keep_ambient_share": keep}
        expected = reference.resolve_samples(*given, **words, threads=1)
        for threads in THREADS:
            got = picture_kernels.resolve_samples(*given, **words, threads=threads)
            assert got.tobytes() == expected.tobytes()


@pytest.mark.usefixtures("instruction_set")
@pytest.mark.parametrize("size", [(48, 64), (37, 53), (1, 1), (2, 9)])
@pytest.mark.parametrize("bloom", [0.0, 0.3])
@pytest.mark.parametrize("noisy", [False, True])
def test_light_is_gathered_as_the_definition_does(
    size: tuple[int, int], bloom: float, noisy: bool
) -> None:
    """Bloom and noise, by themselves and together, on any number of threads."""
    rng = np.random.default_rng(11)
    radiance = rng.exponential(1.0, (*size, 4)).astype(np.float16)
    radiance[0, 0, 0] = 60000.0
    normal = rng.normal(size=65536).astype(np.float32) if noisy else None
    given = radiance, bloom, 1.0 / 300.0, 1e-4, -(2**62) + 12345, normal
    expected = reference.gather_light(*given, threads=1)
    for threads in (1, 3):
        got = picture_kernels.gather_light(*given, threads=threads)
        np.testing.assert_array_equal(got.view(np.uint16), expected.view(np.uint16))


@pytest.mark.usefixtures("instruction_set")
@pytest.mark.parametrize("size", [(48, 64), (37, 53), (1, 1), (2, 9), (0, 4)])
def test_light_is_weakened_as_the_definition_does(size: tuple[int, int]) -> None:
    """By pixels and by colours; sums are those of double precision, on any number of threads."""
    rng = np.random.default_rng(12)
    radiance = rng.exponential(1.0, (*size, 4)).astype(np.float16)
    radiance[:1, :1, 0] = 60000.0
    share = rng.random(size).astype(np.float32)
    factors, offsets = np.array([[0.7, 1.0, 1.3], [0.0, 0.01, 0.5]], np.float32)
    light = radiance[..., :3].astype(np.float64)
    sums = set()
    for threads in (1, 3):
        for weight in (None, share):
            given = radiance, weight, factors, offsets
            got = lens_light.scale_light(*given, threads=threads)
            expected = reference.scale_light(*given, threads=1)
            np.testing.assert_array_equal(got.view(np.uint16), expected.view(np.uint16))
        weighed = lens_light.weigh_light(radiance, share, threads=threads)
        np.testing.assert_allclose(weighed, (light * share[..., None]).sum(axis=(0, 1)), rtol=1e-6)
        sums.add(weighed.tobytes())
    assert len(sums) == 1


def test_the_clients_arrays_are_those_that_numpy_makes() -> None:
    """Grey depth, colours of instances, and flow that is 0 where there is none."""
    rng = np.random.default_rng(5)
    surface = blocky_surface(rng, 130, 211)
    depth = surface[..., 0].copy()
    depth.flat[:9] = [np.nan, np.inf, -np.inf, -1.0, 0.0, 0.05, 10.0, 9.999, 11.0]
    flow = rng.normal(size=(130, 211, 2)).astype(np.float32)
    flow[rng.random((130, 211)) < 0.3] = np.nan
    instance = surface[..., 1].astype(np.uint16)
    expected = {
        "grey": grey_depth(depth, near_m=0.05, range_m=10.0),
        "object": cv2.cvtColor(instance_colours()[instance], cv2.COLOR_RGB2BGR),
        "flow": np.nan_to_num(flow),
        "flow_valid": ~np.isnan(flow[..., 0]),
    }
    given = {"depth": depth, "instance": instance, "flow": flow.copy()}
    made = frame_dict._converted(given, 0.05, 10.0)
    assert made["flow"] is given["flow"]
    assert made.keys() == expected.keys()
    for name, array in made.items():
        assert array.dtype == expected[name].dtype
        np.testing.assert_array_equal(array, expected[name])


def picture_radiance(rng: np.random.Generator, surface: np.ndarray) -> np.ndarray:
    """Light with edges where the surfaces have them, of all magnitudes."""
    ids = surface[..., 1].astype(np.intp)
    light = 10.0 ** rng.uniform(-2.0, 0.7, (60000, 4))
    radiance = light[ids % 60000]
    radiance[..., 3] = rng.random(ids.shape) * 1.2
    radiance[0, :4, :3] = [[0.0, 6e-8, 3e-5], [65504.0, 0.0, 1.0], [1e-7, 1e-6, 1e-5], [9, 9, 9]]
    return radiance.astype(np.float16)
