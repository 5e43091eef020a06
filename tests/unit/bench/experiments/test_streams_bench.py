"""Measures of streams, on pictures whose motion is known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sailenv_bench.experiments.attention import GravitationalFocus
from sailenv_bench.experiments.horn_schunck import MotionScore, horn_schunck_flow
from sailenv_bench.experiments.raw_templates import LabelledFrame, best_f1, draw_templates
from sailenv_bench.experiments.stream_measures import FlowFactor, warp_residual
from sailenv_ros.cli.main import main
from sailenv_ros.dataset.streams import STREAMS, StreamJob, stream_pairs
from sailenv_ros.errors import InvalidRequest

SIZE = 96
WAY = (1.7, -0.9)


def texture(u0: float = 0.0, v0: float = 0.0) -> Any:
    """A picture of waves, moved to the right and down."""
    v, u = np.mgrid[:SIZE, :SIZE].astype(np.float64)
    u, v = u - u0, v - v0
    waves = np.sin(u / 3.1) + np.sin(v / 2.7) + np.sin((u + v) / 4.3) + np.sin((u - 2 * v) / 7.0)
    return np.repeat(np.rint(127 + 30 * waves)[..., None], 3, axis=2).astype(np.uint8)


def pair() -> tuple[Any, Any, Any, Any]:
    """Two pictures, the displacement back, and ids of one object before a border."""
    backward = np.broadcast_to(np.float32(-1.0) * np.array(WAY, np.float32), (SIZE, SIZE, 2)).copy()
    return texture(), texture(*WAY), backward, np.ones((SIZE, SIZE), np.uint16)


@pytest.mark.parametrize("unit", [1.0, 2.0, 0.5])
def test_the_factor_of_flow_is_found(unit: float) -> None:
    """Flow that is stored twice as large has the factor 0.5, and so on, to a hundredth."""
    before, now, backward, ids = pair()
    found = FlowFactor()
    found.add(before, now, backward * np.float32(unit), ids, ids)
    assert found.factor == pytest.approx(1.0 / unit, rel=0.01)
    assert found.left < 0.1
    assert found.pixels > 5000


def test_light_that_stays_where_it_is_does_not_change_the_factor() -> None:
    """What moves comes out of broad shadows and into them; three pairs tell how certain it is."""
    v, u = np.mgrid[:SIZE, :SIZE].astype(np.float64)
    light = (0.7 + 0.3 * np.sin(u / 15.0 + v / 23.0))[..., None]
    found = FlowFactor()
    for shift in (0.0, 5.0, 11.0):
        first, second = (
            np.rint(texture(shift + part * WAY[0], part * WAY[1]) * light).astype(np.uint8)
            for part in (0.0, 1.0)
        )
        backward = np.broadcast_to(-np.array(WAY, np.float32), (SIZE, SIZE, 2)).copy()
        ids = np.ones((SIZE, SIZE), np.uint16)
        found.add(first, second, backward, ids, ids)
    assert found.factor == pytest.approx(1.0, abs=0.01)
    assert 0.0 < found.error < 0.005


def test_nothing_is_told_by_what_does_not_move() -> None:
    before, _, backward, ids = pair()
    found = FlowFactor()
    found.add(before, before, np.zeros_like(backward), ids, ids)
    found.add(before, before, backward, ids, ids + 1)  # another object came there
    assert found.pixels == 0
    assert np.isnan(found.factor)


def test_a_right_warp_leaves_little() -> None:
    before, now, backward, _ = pair()
    inside = np.zeros((SIZE, SIZE), bool)
    inside[8:-8, 8:-8] = True
    assert warp_residual(before, now, backward, inside) < 0.2
    assert warp_residual(before, now, np.zeros_like(backward), inside) == 1.0
    assert warp_residual(before, now, -backward, inside) > 1.0
    assert np.isnan(warp_residual(before, now, backward, np.zeros_like(inside)))


def frame(number: int, shade: int) -> LabelledFrame:
    """A square of class 0 and one of class 1 before a background, which is class 2."""
    classes = np.full((20, 20), 2, np.int32)
    classes[2:8, 2:8], classes[10:18, 10:18] = 0, 1
    colours = np.full((20, 20, 3), 128, np.uint8)
    colours[classes == 0] = (shade, 0, 0)
    colours[classes == 1] = (0, shade, 0)
    return LabelledFrame(
        number=number, colours=colours, classes=classes, moves=classes < 2, focus=(3, 3)
    )


def test_templates_tell_colours_apart() -> None:
    """Objects of own colours are found; of one colour, only by chance."""
    rng = np.random.default_rng(0)
    frames = [frame(number, 200) for number in (0, 50, 100, 150, 200, 300)]
    templates = draw_templates(frames, 2, rng)
    assert len(templates[0]) == 6
    assert best_f1(frames, templates, 2)[0] == 1.0
    # Class 1 of the same colour as class 0: 36 and 64 pixels a frame, of which one class has all.
    alike = [
        LabelledFrame(
            number=one.number,
            colours=np.where(one.classes[..., None] < 2, 200, 128)
            .repeat(3, 2)
            .astype(np.uint8)[..., :3],
            classes=one.classes,
            moves=one.moves,
            focus=one.focus,
        )
        for one in frames
    ]
    whole, focus = best_f1(alike, draw_templates(alike, 2, rng), 2)
    assert whole == pytest.approx((2 * 36 / (36 + 100) + 1.0) / 3)
    assert focus == pytest.approx(1 / 3)


def test_labels_lie_apart() -> None:
    """At most three for each class, each 100 frames from the others, on what moves."""
    frames = [frame(number, 200) for number in range(0, 120, 10)]
    colours, owners = draw_templates(frames, 2, np.random.default_rng(1))
    assert np.bincount(owners).max() <= 2
    assert set(map(tuple, colours.tolist())) == {(200.0, 0.0, 0.0), (0.0, 200.0, 0.0)}


def test_horn_and_schunck_find_a_small_shift() -> None:
    """Half a pixel to the right, of waves; the estimate agrees on average, and explains it."""
    first, second = (texture(shift)[..., 0].astype(np.float32) / 255 for shift in (0.0, 0.6))
    flow = horn_schunck_flow(first, second, smoothness=0.05, iterations=300)
    np.testing.assert_allclose(np.median(flow, axis=(0, 1)), (0.6, 0.0), atol=0.05)
    score = MotionScore()
    score.add(first, second, flow, np.ones((SIZE, SIZE), bool))
    assert score.motion_f1 > 0.85
    assert score.accuracies[0] > 0.9
    still = MotionScore()
    still.add(first, first, np.zeros_like(flow), np.zeros((SIZE, SIZE), bool))
    assert still.accuracies == (1.0, 1.0)
    assert np.isnan(still.motion_f1)


def test_the_focus_falls_to_what_moves() -> None:
    picture = np.full((64, 96, 3), 128, np.uint8)
    moves = np.zeros((64, 96), bool)
    moves[8:14, 70:78] = True
    focus = GravitationalFocus(64, 96)
    track = [focus.follow(picture, moves) for _ in range(80)]
    distances = [np.hypot(row - 11, column - 74) for row, column in track]
    assert min(distances) < 8.0
    assert all(0 <= row < 64 and 0 <= column < 96 for row, column in track)


def test_pairs_follow_each_other() -> None:
    job = StreamJob(
        kind=STREAMS["solid"], frames=40, views=("depth", "instance", "flow"), backend="native"
    )
    numbers = []
    for number, before, now, info in stream_pairs(job, 4):
        assert now.stamp_ns - before.stamp_ns == 125_000_000 == now.dt_ns
        assert before.stamp_ns == (number - 1) * 125_000_000
        assert len(info.instances) == 3
        numbers.append(number)
    assert numbers == [1, 10, 20, 30]
    with pytest.raises(InvalidRequest, match="pairs"):
        next(stream_pairs(job, 21))


def test_bad_options_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "streams", "--pairs", "1", "--no-plots"]) == 2
    assert main(["bench", "streams", "--stream", "kitchen", "--no-plots"]) == 2
    assert "kitchen" in capsys.readouterr().err
