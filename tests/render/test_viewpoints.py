"""Views by rule: what the rule says of each picture is so, by counting its pixels."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from sailenv_bench.experiments.viewpoints import Rule, Stage

RULE = Rule(viewpoints=4, attempts=60)


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    """Two chairs (cubes) in the open, a couch (another) inside of a box."""
    objects = [
        {"name": "floor", "asset": "plane", "static": True, "category": "floor"},
        {"name": "one", "asset": "cube", "category": "chair", "position": [2, 2, 0.5]},
        {"name": "two", "asset": "cube", "category": "chair", "position": [-2, 2, 0.5]},
        {"name": "hidden", "asset": "cube", "category": "couch", "position": [0, -3, 0.25],
         "scale": 0.5},
        {"name": "small", "asset": "cube", "category": "vase", "position": [5, -5, 0.9],
         "scale": 0.2},
        {"name": "block", "asset": "cube", "category": "wall", "position": [5, -5, 0.4],
         "scale": [1.2, 1.2, 0.8]},
        {"name": "pane", "asset": "cube", "category": "wall", "position": [5, -5, 1.3],
         "scale": [1.2, 1.2, 0.2]},
        {"name": "box", "asset": "cube", "category": "wall", "position": [0, -3, 0.26],
         "scale": 0.52},
    ]  # fmt: skip
    for entry in objects:
        entry["static"] = True
    path = tmp_path_factory.mktemp("viewpoints") / "viewpoints.yaml"
    path.write_text(json.dumps({"version": 1, "objects": objects}), encoding="utf-8")
    with Stage([str(path)], 96, 72) as stage:
        yield stage


def test_viewpoints_meet_the_rule(stage: Stage) -> None:
    """Cover, visibility, azimuths; each object has its turn."""
    viewpoints = stage.viewpoints("chair", RULE)
    assert len(viewpoints) == 4
    assert {viewpoint.name for viewpoint in viewpoints} == {"one", "two"}
    for viewpoint in viewpoints:
        assert viewpoint.target.mean() == pytest.approx(viewpoint.cover)
        assert 0.02 <= viewpoint.cover <= 0.6
        assert 0.7 <= viewpoint.visible <= 1.0
        assert (viewpoint.of_category & viewpoint.target).sum() == viewpoint.target.sum()
        assert viewpoint.picture.shape == (72, 96, 3)
    for name in ("one", "two"):
        first, second = (
            viewpoint.azimuth_deg for viewpoint in viewpoints if viewpoint.name == name
        )
        assert abs((first - second + 180) % 360 - 180) >= RULE.apart_deg


def test_the_seed_decides(stage: Stage) -> None:
    """The same one gives the same viewpoints, another one others."""
    first, again = (stage.viewpoints("chair", RULE) for _ in range(2))
    other = stage.viewpoints("chair", replace(RULE, seed=1))
    for one, two in zip(first, again, strict=True):
        np.testing.assert_array_equal(one.picture, two.picture)
    assert [viewpoint.azimuth_deg for viewpoint in first] != [
        viewpoint.azimuth_deg for viewpoint in other
    ]


def test_no_camera_stands_in_another_object(stage: Stage) -> None:
    """Close above the vase hangs a pane that cameras would often be in; none is."""
    viewpoints = stage.viewpoints("vase", replace(RULE, viewpoints=8, attempts=200))
    assert len(viewpoints) > 3
    middle, half = np.array([5.0, -5.0, 1.3]), np.array([0.6, 0.6, 0.1])
    for viewpoint in viewpoints:
        assert (np.abs(np.asarray(viewpoint.eye_m) - middle) > half).any()


def test_what_is_hidden_has_no_viewpoints(stage: Stage) -> None:
    """Fewer viewpoints than asked for are given, not worse ones."""
    assert stage.instances("couch") == 1
    assert stage.viewpoints("couch", replace(RULE, attempts=10)) == []
    assert stage.viewpoints("tv", RULE) == []


def test_the_part_beyond_the_border_counts_as_not_seen(stage: Stage) -> None:
    """Very near cameras cut the object off: whoever wants all of it gets only whole ones."""
    viewpoints = stage.viewpoints("chair", replace(RULE, visible=0.999, cover=(0.05, 0.6)))
    assert viewpoints
    for viewpoint in viewpoints:
        border = np.concatenate(
            [viewpoint.target[[0, -1]].ravel(), viewpoint.target[:, [0, -1]].ravel()]
        )
        assert border.sum() <= 2
