"""Drifts: what is recorded equals arithmetic, and is what the frames show."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from sailenv_ros.streams import Course, DriftRecord, Stream
from sailenv_ros.streams.drifts.daylight import Daylight
from sailenv_ros.streams.drifts.lamps import LampAge
from sailenv_ros.streams.drifts.mount import Mount
from sailenv_ros.streams.drifts.paint import Paint
from sailenv_ros.streams.drifts.sensor import SensorDrift
from sailenv_ros.streams.drifts.wear import Wear
from sailenv_ros.streams.state import StreamState


def test_a_day_has_noon_dusk_and_midnight() -> None:
    drift = Daylight(day=2400, year=10**9, night=0.1, season=0.0)
    found = {}
    for hour in (12, 15, 18, 24):
        state = StreamState()
        record = drift.apply(state, (hour - 12) * 100, 0)
        assert record.values["hour"] == pytest.approx(hour % 24)
        found[hour] = state
    assert found[12].daylight == pytest.approx(1.0)
    assert found[15].daylight == pytest.approx(0.1 + 0.9 * math.sqrt(math.cos(math.pi / 4)))
    assert found[18].daylight == pytest.approx(0.1)
    assert found[24].daylight == 0.1
    assert found[12].daylight_colour == (1.0, 1.0, 1.0)
    assert found[18].daylight_colour[2] < found[18].daylight_colour[0] == 1.0
    assert (found[12].lamplight, found[24].lamplight) == (0.2, 1.0)


def test_noon_is_darkest_half_a_year_from_summer() -> None:
    drift = Daylight(day=2, year=4000, season=0.5)
    noons = [drift.apply(StreamState(), frame, 0).values["share"] for frame in (1000, 3000)]
    assert noons == pytest.approx([1.0, 0.5])


def test_lamps_age_and_are_replaced() -> None:
    drift = LampAge(onset=100, life=50, left=0.4)
    power = [drift.apply(StreamState(), frame, 0) for frame in (0, 100, 125, 149, 150, 175)]
    assert [record.values["power"] for record in power] == pytest.approx(
        [1.0, 1.0, 0.7, 1 - 0.6 * 49 / 50, 1.0, 0.7]
    )
    assert [record.since for record in power] == [100, 100, 100, 100, 150, 150]
    assert [record.active for record in power] == [False] + [True] * 5


def test_walls_have_another_colour_after_each_painting() -> None:
    drift = Paint(onset=10, every=5, colours=((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    for seed in range(8):
        colours = [drift.apply(StreamState(), 10 + 5 * time, seed).values["colour"]
                   for time in range(9)]  # fmt: skip
        assert all(a != b for a, b in pairwise(colours))
        assert set(colours[:3]) == set(drift.colours)
        assert drift.apply(StreamState(), 9, seed).active is False
        assert drift.apply(StreamState(), 17, seed).since == 15


def test_sensors_wear_and_mounts_keep_to_their_spans() -> None:
    sensor = SensorDrift(setting="gain", onset=10, over=20, begin=1.0, end=3.0)
    found = [sensor.apply(StreamState(), frame, 0).values["gain"] for frame in (0, 10, 20, 99)]
    assert found == [1.0, 1.0, 2.0, 3.0]
    wear = Wear(onset=0, over=10, most=0.5)
    assert [wear.apply(StreamState(), n, 0).values["worn"] for n in (0, 5, 50)] == [0, 0.25, 0.5]
    mount = Mount(onset=0, every=1, turn=3.0, shift=0.1, zoom=0.2)
    for frame in range(200):
        state = StreamState()
        mount.apply(state, frame, 1)
        assert np.abs(state.mount_rpy_deg).max() <= 3.0
        assert np.abs(state.mount_m).max() <= 0.1
        assert 0.8 <= state.zoom <= 1.2


def test_frames_show_what_is_recorded(stream: Stream, course: Course) -> None:
    cup, laptop = (stream[0].frame.info.categories.named(name).id for name in ("cup", "laptop"))
    for number in (0, 13, 31, 67):
        made = stream[number]
        frame, drift = made.frame, made.drift
        assert drift == stream.drift(number)
        episode = number // course.episode * course.episode
        there = {one.category_id for one in frame.info.instances}
        assert (cup in there, laptop in there) == (episode >= 12, episode < 24)
        lights = {light.name: light for light in frame.info.lights}
        tick = course.state(max(episode, number // 50 * 50), 5)[0]
        assert lights["window light"].intensity == pytest.approx(2.0 * tick.daylight)
        assert lights["lamp"].intensity == pytest.approx(1.0 * tick.lamplight)
        (agent,) = (one for one in frame.info.agents if one.name == "stream_eye")
        assert agent.picture.gain == tick.picture["gain"]
        ahead = (0.0, 0.1, 1.0)
        own, plain = (lens.project(ahead) - lens.project((0.0, 0.0, 1.0))
                      for lens in (frame.camera.intrinsics, course.eye.lens()))  # fmt: skip
        assert own[1] / plain[1] == pytest.approx(tick.zoom)


def test_walls_are_painted(stream: Stream) -> None:
    """By what is seen of them: the strongest channel is that of the paint."""
    for number in (13, 25, 37):
        made = stream[number]
        colour = made.drift["paint"].values["colour"]
        walls = made.frame.info.categories.named("wall").id
        seen = made["rgb"][made["category"] == walls].astype(float).mean(axis=0)
        assert int(np.argmax(seen)) == int(np.argmax(colour))


def test_a_record_is_plain_data() -> None:
    record = DriftRecord(values={"share": 0.5}, since=3, active=True)
    assert record == DriftRecord(values={"share": 0.5}, since=3, active=True)
