"""Cameras of recipes look at furniture rather than at bare walls."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from sailenv_ros.assets.categories import load_categories
from sailenv_ros.dataset import engine_of, load_job, make_dataset, open_dataset
from sailenv_ros.system.resources import resource_path

HALL: dict[str, Any] = {
    "version": 1,
    "room": {"size": [8, 5, 3]},
    "lights": [{"name": "lamp", "type": "point", "position": [0, 0, 2.5], "intensity": 3}],
    "objects": [
        {"name": f"crate {number}", "asset": "cube", "position": [3, y, 0.5], "static": True}
        for number, y in enumerate((-1.8, -0.6, 0.6, 1.8))
    ],
}


def shares(folder: Path, camera: dict[str, Any], **clip: Any) -> list[float]:
    """Return which share of each frame objects take, of clips in a hall furnished at one end."""
    folder.mkdir()
    (folder / "hall.yaml").write_text(yaml.safe_dump(HALL))
    recipe = {
        "version": 1,
        "seed": 8,
        "light": "plain",
        "scenes": [{"scene": "hall.yaml"}],
        "clips": {"train": 12},
        "clip": {"per_scene": 6, "gap": 0.1, **clip},
        "cameras": [{"width": 96, "height": 72, **camera}],
        "views": ["category"],
        "formats": ["webdataset"],
    }
    path = folder / "recipe.yaml"
    path.write_text(yaml.safe_dump(recipe))
    made = make_dataset(load_job(path), folder / "made", engine_of(1, None))
    assert not made.skipped
    with open_dataset(folder / "made") as frames:
        cube = load_categories().named("cube").id
        return [float((one.frame["category"] == cube).mean()) for one in frames]


def test_a_walk_keeps_furniture_in_view(tmp_path: Path) -> None:
    """All the way, where free walks see bare walls; and it walks."""
    walk = {"type": "walk", "eye_height": [1.2, 1.4], "pitch": [10, 15]}
    clip = {"frames": 5, "rate": 2}
    free = shares(tmp_path / "free", walk, **clip)
    kept = shares(tmp_path / "kept", {**walk, "filled": 0.04}, **clip)
    assert sum(one < 0.04 for one in free) > len(free) / 4
    assert min(kept) >= 0.03  # the rule looks at smaller pictures
    with open_dataset(tmp_path / "kept" / "made") as frames:
        places = [one.frame.camera.pose.position_m for one in frames]
    assert len({place[:2] for place in places}) == len(places)


def test_room_view_sees_furniture_in_every_clip(tmp_path: Path) -> None:
    """Also where clips begin one after another in the same room."""
    seen = shares(
        tmp_path / "room",
        {"type": "rule", "rule": "room_view", "settings": {"attempts": 120, "objects": 2}},
    )
    assert len(seen) == 12
    assert min(seen) > 0.01


@pytest.mark.parametrize("name", ["detection", "flow"])
def test_shipped_recipes_look_into_the_room(name: str) -> None:
    """By the rule, or by the share that walks keep."""
    recipe = yaml.safe_load((resource_path("config", "recipes") / f"{name}.yaml").read_text())
    for camera in recipe["cameras"]:
        assert camera.get("rule") == "room_view" or camera["filled"] > 0.0
