"""The retina beside arithmetic, and the wrappers of observations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.gym.retina import INNERMOST_PX, Retina
from sailenv_ros.gym.room_env import RoomEnv
from sailenv_ros.gym.wrappers import LogPolarRetina, Motion

Make = Callable[..., RoomEnv]


def test_a_picture_of_one_colour_stays_so() -> None:
    view = np.full((40, 60, 3), (7, 100, 255), np.uint8)
    seen = Retina(60, 40, 12, 16).sample(view, mean=True)
    assert seen.shape == (12, 16, 3)
    assert seen.dtype == np.uint8
    assert (seen == (7, 100, 255)).all()


def test_cells_are_the_mean_of_their_pixels() -> None:
    width, height, rings, wedges = 41, 31, 8, 12
    view = np.random.default_rng(0).integers(0, 256, (height, width), np.uint8)
    seen = Retina(width, height, rings, wedges).sample(view, mean=True)
    growth = (min(width, height) / 2 / INNERMOST_PX) ** (1 / (rings - 1))
    sums, counts = np.zeros((rings, wedges)), np.zeros((rings, wedges))
    for v in range(height):
        for u in range(width):
            x, y = u - (width - 1) / 2, v - (height - 1) / 2
            edges = INNERMOST_PX * growth ** np.arange(rings) * (1 + 1e-12)
            ring = int(np.searchsorted(edges, np.hypot(x, y)))
            if ring < rings:
                wedge = int(np.arctan2(y, x) / (2 * np.pi) % 1.0 * wedges) % wedges
                sums[ring, wedge] += view[v, u]
                counts[ring, wedge] += 1
    there = counts > 0
    assert there.sum() > 0.6 * rings * wedges
    assert (seen[there] == np.floor(sums[there] / counts[there] + 0.5)).all()


def test_labels_are_never_mixed() -> None:
    view = np.where(np.arange(60) < 30, 3, 200)[None].repeat(40, axis=0).astype(np.uint8)
    seen = Retina(60, 40, 10, 16).sample(view, mean=False)
    assert set(seen.reshape(-1).tolist()) == {3, 200}
    assert (seen[:, :4] == 200).all()  # the first quarter turn: right and below
    assert (seen[:, 5:8] == 3).all()


def test_the_setting_and_the_wrapper_are_the_same(make: Make) -> None:
    views = ("rgb", "depth", "instance")
    own = make("Track", views=views, retina=(9, 16))
    wrapped = LogPolarRetina(make("Track", views=views), 9, 16)
    for env in (own, wrapped):
        env.reset(seed=3)
    first, second = own.step(1)[0], wrapped.step(1)[0]
    assert own.observation_space == wrapped.observation_space
    for name in views:
        assert (first[name] == second[name]).all()
    assert wrapped.observation_space.contains(second)


def test_motion_is_the_length_of_flow(make: Make) -> None:
    env = Motion(make("Track", views=("flow",), turn_deg=3.0, width=64, height=48))
    observation, _ = env.reset(seed=0)
    assert not observation["motion"].any()  # nothing was seen before
    observation, *_ = env.step(1)
    assert env.observation_space.contains(observation)
    flow = observation["flow"].astype(np.float64)
    assert observation["motion"] == pytest.approx(np.hypot(flow[..., 0], flow[..., 1]) / 30.0)
    # A turn by 3 degrees to the left moves the picture to the right: by f·tan(3°) in the middle of
    # a level one, by up to twice that at its sides.
    least_px = 24 / np.tan(np.radians(37.5)) * np.tan(np.radians(3.0))
    middle = np.median(flow[..., 0]) / 30.0
    assert 0.8 * least_px < middle < 2.0 * least_px


def test_bad_retinas_are_refused(make: Make) -> None:
    for retina in ((1, 8), (8, 3), (8,), "fine"):
        with pytest.raises(InvalidRequest, match=r"retina|rings|wedges"):
            make("Track", retina=retina)
    with pytest.raises(InvalidState, match="flow"):
        Motion(make("Track"))
