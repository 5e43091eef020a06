"""Automatic exposure against arithmetic: what the meter asks for, and how fast it is followed."""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros import Simulation
from sailenv_ros.frame.frame import Frame
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.picture.auto_exposure import HIGHLIGHT, MAX_STOPS
from sailenv_ros.types.bayer import BLACK_LEVEL, WHITE_LEVEL
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import AdaptedExposure, Observation, WorldSnapshot
from tests.support.tiny_scenes import Thing, camera_at, model_of, snapshot_of, wall_mesh

AUTOMATIC = PictureSettings(tone_curve="linear", auto_exposure_s=0.5)
WEIGHTS = (0.2126, 0.7152, 0.0722)
BLACK = Environment(
    background="colour",
    background_colour=(0, 0, 0),
    sky_zenith=(0, 0, 0),
    sky_horizon=(0, 0, 0),
    sky_ground=(0, 0, 0),
)
SPAN = WHITE_LEVEL - BLACK_LEVEL


def plain(*colour: float, at_ns: int = 0) -> WorldSnapshot:
    """Return nothing before a background of one radiance."""
    red, green, blue = colour * 3 if len(colour) == 1 else colour
    surroundings = Environment(background="colour", background_colour=(red, green, blue))
    return replace(snapshot_of([], environment=surroundings), sim_time_ns=at_ns)


def eye(settings: PictureSettings = AUTOMATIC) -> Camera:
    return replace(camera_at(), picture=settings, name="eye")


def wanted(luminance: float) -> float:
    """Return the stops that the meter asks for before one luminance."""
    stops = math.log2(0.18) - math.log2(luminance + 1e-4)
    return min(max(stops, -8.0), 8.0)


@pytest.mark.parametrize("colour", [(0.5,), (0.125, 0.25, 0.5), (4.0,), (0.0,), (100.0,)])
def test_the_first_picture_is_of_middle_grey(
    renderer: RenderBackend, colour: tuple[float, ...]
) -> None:
    """Whatever light there is, up to eight stops; RAW data and picture are of that exposure."""
    made = renderer.render(RenderRequest(plain(*colour), eye(), ("rgb", "raw")))
    luminance = float(np.dot(WEIGHTS, colour * 3 if len(colour) == 1 else colour))
    assert made.adapted is not None
    assert made.adapted.stops == pytest.approx(wanted(luminance), abs=1e-9)
    by_hand = replace(AUTOMATIC, auto_exposure_s=0.0, exposure=made.adapted.stops)
    fixed = renderer.render(RenderRequest(plain(*colour), eye(by_hand), ("rgb", "raw")))
    assert fixed.adapted is None
    for view in ("rgb", "raw"):
        np.testing.assert_array_equal(made.views[view], fixed.views[view])
    if 2.0**-7 < luminance < 32.0 and len(colour) == 1:
        share = (made.views["raw"] - float(BLACK_LEVEL)) / SPAN
        np.testing.assert_allclose(share, 0.18, rtol=2e-2 if luminance < 0.1 else 1e-3)


def shining(radiance: float, side: float) -> Thing:
    """Return a wall that fills the picture's left half or its right one, and shines."""
    wall = model_of(wall_mesh(40.0, 40.0), base_colour=(0, 0, 0, 1), emission=(radiance,) * 3)
    return Thing(wall, Pose((2.0, 20.0 * side, 0.0)))


def dark(*things: Thing, sky: Environment = BLACK) -> WorldSnapshot:
    """Return things without a light on them."""
    return snapshot_of(things, environment=sky, lights=())


def test_the_meter_takes_the_mean_of_logarithms(renderer: RenderBackend) -> None:
    """Half of the picture 64 times as bright: three stops, not six."""
    halves = [shining(16.0, 1.0), shining(0.25, -1.0)]
    camera = eye(replace(AUTOMATIC, occlusion_strength=0.0))
    made = renderer.render(RenderRequest(dark(*halves), camera, ("rgb",)))
    assert made.adapted is not None
    mean = 0.5 * (math.log2(0.25 + 1e-4) + math.log2(16.0 + 1e-4))
    # The column in the middle may be of either.
    assert made.adapted.stops == pytest.approx(math.log2(0.18) - mean, abs=6.0 / 72)


def test_highlights_are_protected_and_the_sky_does_not_count(renderer: RenderBackend) -> None:
    """Half 1,024 times as bright would be white; a sky in its place changes nothing."""
    camera = eye(replace(AUTOMATIC, occlusion_strength=0.0))
    halves = [shining(16.0, 1.0), shining(2.0**-6, -1.0)]
    made = renderer.render(RenderRequest(dark(*halves), camera, ("rgb",)))
    assert made.adapted is not None
    assert made.adapted.stops == pytest.approx(math.log2(HIGHLIGHT / (16.0 + 1e-4)), abs=1e-3)
    sky = replace(BLACK, background_colour=(16.0, 16.0, 16.0))
    made = renderer.render(RenderRequest(dark(shining(0.25, 1.0), sky=sky), camera, ("rgb",)))
    assert made.adapted is not None
    assert made.adapted.stops == pytest.approx(wanted(0.25), abs=0.2)


def test_the_way_there_is_exponential(renderer: RenderBackend) -> None:
    """And `exposure` comes on top, up to what pictures may have."""
    before = AdaptedExposure(3.0, 1_000_000_000)
    past = Observation(snapshot=plain(0.5, at_ns=1_000_000_000), camera=eye(), adapted=before)
    now = plain(0.5, at_ns=1_200_000_000)
    brighter = eye(replace(AUTOMATIC, exposure=1.0))
    made = renderer.render(RenderRequest(now, brighter, ("raw",), past))
    assert made.adapted is not None
    stops = wanted(0.5) + (3.0 - wanted(0.5)) * math.exp(-0.2 / 0.5)
    assert made.adapted.stops == pytest.approx(stops, abs=1e-9)
    expected = BLACK_LEVEL + SPAN * min(0.5 * 2.0 ** (stops + 1.0), 1.0)
    assert np.abs(made.views["raw"] - expected).max() <= 0.5
    no_picture = renderer.render(RenderRequest(now, eye(), ("depth",), past))
    assert no_picture.adapted == before
    off = eye(replace(AUTOMATIC, auto_exposure_s=0.0))
    assert renderer.render(RenderRequest(now, off, ("depth",), past)).adapted is None
    dark = eye(replace(AUTOMATIC, exposure=15.0))
    assert renderer.render(RenderRequest(plain(0.0), dark, ("raw",))).adapted == (MAX_STOPS, 0)


@pytest.fixture
def simulation() -> Iterator[Simulation]:
    """A room without a lamp on, seen small."""
    with Simulation(
        "room_01",
        width=64,
        height=48,
        views=("rgb", "raw", "depth"),
        light="plain",
        mode="lockstep",
    ) as made:
        yield made


def test_an_agent_s_eye_adapts(simulation: Simulation) -> None:
    """As light changes, by simulated time; pictures of an instant are equal; a reset ends it."""
    simulation.set_follow(False)  # it stands still
    fixed = simulation.capture()
    simulation.set_picture(auto_exposure_s=0.2)
    first = simulation.capture()
    assert fixed.exposure == 0.0
    assert first.exposure != 0.0
    simulation.set_environment(exposure=simulation.info.environment.exposure + 2.0)
    darker = _steps(simulation, 8)
    again = simulation.capture()
    assert again.exposure == darker[-1].exposure
    assert again["rgb"].tobytes() == darker[-1]["rgb"].tobytes()
    assert again["depth"].tobytes() == fixed["depth"].tobytes()
    assert pickle.loads(pickle.dumps(again)).exposure == again.exposure
    simulation.set_picture(auto_exposure_s=1e-6)  # at once, but for the instant itself
    simulation.step(1)
    there = simulation.capture().exposure
    assert first.exposure - there > 1.5
    ratios = [(frame.exposure - there) / (first.exposure - there) for frame in darker]
    passed = [(frame.stamp_ns - first.stamp_ns) * 1e-9 for frame in darker]
    np.testing.assert_allclose(ratios, np.exp(-np.array(passed) / 0.2), atol=2e-3)
    simulation.reset()
    assert simulation.capture().exposure == pytest.approx(first.exposure, abs=1e-9)


def _steps(simulation: Simulation, count: int) -> list[Frame]:
    frames = []
    for _ in range(count):
        simulation.step(12)
        simulation.capture("depth")  # a frame without a picture between them changes nothing
        simulation.step(12)
        frames.append(simulation.capture())
    return frames
