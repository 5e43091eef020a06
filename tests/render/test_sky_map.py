"""A photographed sky stands where it should: east, north, west, south, above, nowhere else."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.assets import load_categories
from sailenv_ros.assets.kept_skies import kept_sky
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.assets.skies import load_sky, sky_files
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.scene.seen_sky import FINER, seen_sky
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.lights import Environment, SkyMap
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.world import World

COLOURS = {"east": (1, 0, 0), "north": (0, 1, 0), "west": (0, 0, 1), "south": (1, 1, 0)}
TOWARDS = {"east": (1, 0, 0), "north": (0, 1, 0), "west": (-1, 0, 0), "south": (0, -1, 0)}
GREY = (0.2, 0.2, 0.2)


def painted_sky() -> SkyMap:
    """Quarters of one colour around the middle columns, black above and below 60°."""
    radiance = np.zeros((60, 120, 3), np.float16)
    for quarter, name in enumerate(("east", "south", "west", "north")):
        columns = (np.arange(120 // 4) + 60 - 15 + 30 * quarter) % 120
        radiance[10:50, columns] = COLOURS[name]
    return SkyMap(radiance=radiance, zenith=GREY, horizon=GREY, ground=GREY)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    cube = Primitives().load("cube")
    world = World(
        scene="sky",
        epoch=1,
        placements=[
            Placement(name="cube", asset=cube, category_id=1, pose=Pose((0, 0, -50)), static=True)
        ],
        movers=[Mover(name="mover", start=Pose(), track=None, controller="waypoint")],
        categories=load_categories(),
        environment=Environment(sky=painted_sky(), sky_map="painted"),
    )
    yield world
    world.close()


@pytest.mark.parametrize("name", COLOURS)
def test_each_quarter_is_where_it_belongs(name: str, world: World, renderer: RenderBackend) -> None:
    """Looking along an axis of the world shows the colour of that quarter in the middle."""
    camera = Camera(
        intrinsics=CameraIntrinsics(width=33, height=33, vertical_fov_deg=60.0),
        pose=look_at((0, 0, 0), TOWARDS[name]),
    )
    rendered = renderer.render(RenderRequest(world.snapshot(), camera, ("rgb", "instance")))
    middle = rendered.views["rgb"][12:21, 12:21].reshape(-1, 3).mean(axis=0)
    bright = tuple(int(channel > 150) for channel in middle)
    assert bright == COLOURS[name]
    assert (rendered.views["instance"] == 0).all()


def test_a_sky_is_blended_unless_its_radiance_is_wanted(
    world: World, renderer: RenderBackend
) -> None:
    """A sky as bright as white paper in the sun, in a picture that is exposed for a room."""
    towards_east = Camera(
        intrinsics=CameraIntrinsics(width=33, height=33, vertical_fov_deg=30.0),
        pose=look_at((0, 0, 0), (1, 0, 0)),
    )
    bright = replace(painted_sky(), radiance=np.full((60, 120, 3), 6.0, np.float16))
    before = world.contents.environment
    seen = {}
    try:
        for blend in (True, False):
            world.set_environment(Environment(sky=bright, sky_map="painted", sky_blend=blend))
            rendered = renderer.render(RenderRequest(world.snapshot(), towards_east, ("rgb",)))
            seen[blend] = int(rendered.views["rgb"][16, 16].min())
    finally:
        world.set_environment(before)
    assert seen[False] >= 250
    assert seen[True] <= 235


@pytest.mark.parametrize("blend", [True, False])
def test_a_sky_is_seen_with_a_factor(world: World, renderer: RenderBackend, blend: bool) -> None:
    """Linear light of the picture is in that proportion; the same light is in the room."""
    camera = Camera(
        intrinsics=CameraIntrinsics(width=33, height=33, vertical_fov_deg=30.0),
        pose=look_at((0, 0, 0), (1, 0, 0)),
        picture=PictureSettings(tone_curve="linear"),
    )
    grey = replace(painted_sky(), radiance=np.full((60, 120, 3), 0.16, np.float16))
    before = world.contents.environment
    light = {}
    try:
        for factor in (1.0, 0.25, 4.0):
            world.set_environment(
                Environment(sky=grey, sky_map="painted", sky_blend=blend, outside_factor=factor)
            )
            rendered = renderer.render(RenderRequest(world.snapshot(), camera, ("rgb",)))
            light[factor] = float(linear_from_srgb(rendered.views["rgb"][16, 16, 0] / 255.0))
    finally:
        world.set_environment(before)
    assert light[0.25] == pytest.approx(0.25 * light[1.0], rel=0.04)
    assert light[4.0] == pytest.approx(4.0 * light[1.0], rel=0.04)


def test_above_is_the_first_row(world: World, renderer: RenderBackend) -> None:
    """The zenith of this sky is black."""
    camera = Camera(
        intrinsics=CameraIntrinsics(width=33, height=33, vertical_fov_deg=30.0),
        pose=look_at((0, 0, 0), (0.01, 0, 1)),
    )
    rendered = renderer.render(RenderRequest(world.snapshot(), camera, ("rgb",)))
    assert rendered.views["rgb"].max() < 5


def test_skies_are_found_and_checked(tmp_path: Path) -> None:
    """Each file is loaded once; other shapes and unknown names are refused."""
    (tmp_path / "skies").mkdir()
    np.save(tmp_path / "skies" / "good.npy", np.ones((4, 8, 3), np.float16))
    np.save(tmp_path / "skies" / "odd.npy", np.ones((4, 9, 3), np.float16))
    (tmp_path / "skies" / "junk.npy").write_bytes(b"junk")
    files = sky_files([tmp_path])
    assert load_sky("good", files) is load_sky("good", files)
    assert load_sky("good", files).zenith == (1.0, 1.0, 1.0)
    for name in ("odd", "junk"):
        with pytest.raises(AssetError, match=name):
            load_sky(name, files)
    with pytest.raises(UnknownName, match="did you mean 'good'"):
        load_sky("goood", files)


def test_skies_that_nothing_uses_are_not_kept(tmp_path: Path) -> None:
    """But for the last one: they are 3 MB each, and a stream sees them all."""
    files = {f"sky_{number}": tmp_path / f"sky_{number}.npy" for number in range(6)}
    for path in files.values():
        np.save(path, np.ones((4, 8, 3), np.float16))
    used = kept_sky("sky_0", files, 90.0)
    left = [weakref.ref(kept_sky(name, files, 90.0 * k)) for name in files for k in (0, 1)]
    gc.collect()
    assert [one() is not None for one in left] == [False, True, *9 * [False], True]
    assert kept_sky("sky_0", files, 90.0) is used
    with pytest.raises(UnknownName, match="did you mean 'sky_5'"):
        kept_sky("sky_55", files, 90.0)


def test_a_sky_is_turned_counter_clockwise(tmp_path: Path) -> None:
    """By a quarter what was towards +x is towards +y, which lies left of the middle column."""
    radiance = np.zeros((8, 16, 3), np.float16)
    radiance[3, 8] = 5.0
    np.save(tmp_path / "spot.npy", radiance)
    files = {"spot": tmp_path / "spot.npy"}
    turned = load_sky("spot", files, 90.0)
    assert np.argwhere(turned.radiance[..., 0]).tolist() == [[3, 4]]
    assert load_sky("spot", files, 90.0) is turned is load_sky("spot", files, -270.0)
    assert load_sky("spot", files, 360.0) is load_sky("spot", files)
    assert turned.horizon == load_sky("spot", files).horizon


def _even(luminance: float) -> NDArray[np.float16]:
    return np.full((64, 128, 3), luminance, np.float16)


def _sky(radiance: NDArray[np.float16]) -> SkyMap:
    return SkyMap(radiance=radiance, zenith=GREY, horizon=GREY, ground=GREY)


@pytest.mark.parametrize("exposure", [0.0, 1.0])
def test_only_what_is_bright_is_blended(exposure: float) -> None:
    """Below the knee a sky is as it is; broad brightness ends at the shoulder."""
    for exposed, low, high in (
        (0.1, 0.1, 0.1),
        (0.4, 0.3, 0.4),
        (5.0, 0.6, 0.63),
        (80.0, 0.6, 0.63),
    ):
        seen = seen_sky(_sky(_even(exposed / 2.0**exposure)), exposure).astype(np.float64)
        assert seen.shape == (64 * FINER, 128 * FINER, 3)
        assert low * 0.99 <= seen.min() * 2.0**exposure
        assert seen.max() * 2.0**exposure <= high * 1.01
    ramp = _even(1.0) * np.geomspace(0.01, 50.0, 128)[None, :, None].astype(np.float16)
    assert seen_sky(_sky(ramp.astype(np.float16)), exposure).max() * 2.0**exposure < 1.0


def test_fine_differences_of_what_is_bright_stay() -> None:
    """Twigs that take a fifth of a white sky's light stay as dark against it."""
    radiance = _even(4.0)
    radiance[:, ::8] = radiance[:, 1::8] = 3.2
    seen = seen_sky(_sky(radiance), 1.0).astype(np.float64)[32, 32:-32, 1]
    assert seen.max() / seen.min() > 4.0 / 3.2
    unchanged = seen_sky(_sky(radiance)).astype(np.float64)
    assert unchanged.mean() == pytest.approx(float(radiance.mean(dtype=np.float64)), rel=0.01)


def test_a_sky_that_was_kept_is_the_one_that_is_made(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """On disk by its content and exposure."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    ramp = (_even(1.0) * np.geomspace(0.01, 50.0, 128)[None, :, None]).astype(np.float16)
    made, read, other = (seen_sky(_sky(ramp), exposure) for exposure in (1.0, 1.0, 2.0))
    assert len(list((tmp_path / "arrays").glob("sky-*"))) == 2
    np.testing.assert_array_equal(made, read)
    assert (other != read).any()


def test_a_bright_sky_is_not_white(world: World, renderer: RenderBackend) -> None:
    """Not even of a hundred times the brightness that is white at this exposure."""
    snapshot = world.snapshot()
    environment = Environment(sky=_sky(_even(100.0)), sky_map="glaring", exposure=1.0)
    contents = replace(snapshot.contents, environment=environment)
    camera = Camera(
        intrinsics=CameraIntrinsics(width=33, height=33, vertical_fov_deg=60.0),
        pose=look_at((0, 0, 0), (1.0, 0.0, 0.0)),
    )
    shown = renderer.render(RenderRequest(replace(snapshot, contents=contents), camera, ("rgb",)))
    assert shown.views["rgb"].min() > 150
    assert shown.views["rgb"].max() < 240
