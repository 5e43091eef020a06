"""Baselines of endless streams: derivatives, what they remember, the command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sailenv_bench.experiments.pixel_learners import LEARNERS, NearestTemplate, patches
from sailenv_bench.experiments.small_convnet import PATCH_PX, SmallConvNet
from sailenv_ros.cli.main import main
from sailenv_ros.streams import LabelledPixels

COURSE = """
version: 1
rate: 30
episode: 8
rooms: {scenes: [optical]}
eye: {width: 48, height: 32, walk: 0, carry: 0, fixate: 0, stand: 1}
moves: {open: 0, pushed: 0}
"""


def test_derivatives_are_those_of_the_loss() -> None:
    """Along a random direction in each weight, by central differences in double precision."""
    rng = np.random.default_rng(0)
    net = SmallConvNet(1)
    net.weights["scores"] += rng.normal(0.0, 0.1, net.weights["scores"].shape)
    net.weights = {name: value.astype(np.float64) for name, value in net.weights.items()}
    seen, labels = rng.random((4, PATCH_PX, PATCH_PX, 3)), rng.integers(0, 5, 4)
    slopes = net.gradients(seen, labels)  # type: ignore[arg-type]
    for name, value in list(net.weights.items()):
        way, losses = rng.normal(size=value.shape), []
        for step in (1e-7, -1e-7):
            net.weights[name] = value + step * way  # type: ignore[assignment]
            losses.append(net.loss(seen, labels))  # type: ignore[arg-type]
        net.weights[name] = value
        change = (losses[0] - losses[1]) / 2e-7
        assert (slopes[name] * way).sum() == pytest.approx(change, rel=0.01, abs=1e-4), name


def test_patches_repeat_the_edges() -> None:
    rgb = np.random.default_rng(1).integers(0, 256, (20, 30, 3), np.uint8)
    rows, columns = np.array([0, 7, 19]), np.array([29, 12, 0])
    found = patches(rgb, rows, columns, 5)
    padded = np.pad(rgb, ((2, 2), (2, 2), (0, 0)), mode="edge")
    for one, row, column in zip(found, rows, columns, strict=True):
        np.testing.assert_array_equal(
            one, padded[row : row + 5, column : column + 5] / np.float32(255.0)
        )


@pytest.mark.parametrize("name", sorted(LEARNERS))
def test_a_learner_says_nothing_first_and_then_what_it_was_told(name: str) -> None:
    """Left of a picture is class 40, right is 7; equal seeds learn the same."""
    rgb = np.zeros((40, 80, 3), np.uint8)
    rgb[:, 40:] = (200, 120, 30)
    rows, columns = np.full(4, 20), np.array([10, 15, 60, 70])
    told = LabelledPixels(0, rgb, rows, columns, np.array([40, 40, 7, 7]))
    first, second = LEARNERS[name](3), LEARNERS[name](3)
    assert first.predict(rgb, rows, columns).tolist() == [-1] * 4
    for learner in (first, second):
        for _ in range(60):
            learner.learn(told)
    at = np.full(3, 18), np.array([12, 63, 68])
    said = first.predict(rgb, *at)
    np.testing.assert_array_equal(said, second.predict(rgb, *at))
    assert said.tolist() == ([40] * 3 if name == "frequent" else [40, 7, 7])


def test_the_nearest_template_is_the_nearest(monkeypatch: pytest.MonkeyPatch) -> None:
    """As by brute force; the oldest are forgotten."""
    import sailenv_bench.experiments.pixel_learners as module

    monkeypatch.setattr(module, "MOST_TEMPLATES", 12)
    rng = np.random.default_rng(2)
    learner, known = NearestTemplate(0), []
    for number in range(5):
        rgb = rng.integers(0, 256, (30, 30, 3), np.uint8)
        rows, columns = rng.integers(0, 30, (2, 4))
        learner.learn(LabelledPixels(number, rgb, rows, columns, np.arange(4) + 10 * number))
        known += list(zip(patches(rgb, rows, columns, 9), np.arange(4) + 10 * number, strict=True))
    known = known[-12:]
    rows, columns = rng.integers(0, 30, (2, 6))
    distances = [
        [((one - template) ** 2).sum() for template, _ in known]
        for one in patches(rgb, rows, columns, 9)
    ]
    expected = [int(known[place][1]) for place in np.argmin(distances, axis=1)]
    assert learner.predict(rgb, rows, columns).tolist() == expected


def test_the_command_writes_figures_of_each_learner(tmp_path: Path) -> None:
    (tmp_path / "still.yaml").write_text(COURSE)
    words = ["bench", "endless", "--course", str(tmp_path / "still.yaml"), "--frames", "12"]
    words += ["--stride", "2", "--every", "0", "-o", str(tmp_path / "out"), "--no-plots"]
    assert main(words) == 0
    data = json.loads((tmp_path / "out" / "endless.json").read_text())["data"]
    assert [entry["name"] for entry in data["learners"]] == list(LEARNERS)
    assert data["frames"] == 12
    by_name = {entry["name"]: entry["accuracy"] for entry in data["learners"]}
    # Nothing moves: whoever looks at pictures does better than who does not.
    assert by_name["templates"] > by_name["frequent"]
    assert all(len(entry["checkpoints"]) == 1 for entry in data["learners"])


def test_wrong_options_of_the_command_are_told() -> None:
    for words in (["--stride", "0"], ["--begin", "-1"], ["--learner", "oracle"], ["--labels", "0"]):
        assert main(["bench", "endless", *words, "--no-plots"]) == 2
