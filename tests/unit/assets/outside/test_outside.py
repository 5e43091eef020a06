"""What lies outside rooms: the same for the same seed, small, in its place, of no effect inside."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros.assets import AssetLibrary
from sailenv_ros.assets.outside import Daylight, outside_asset
from sailenv_ros.assets.outside.building import _made
from sailenv_ros.assets.outside.kinds.street import HOUSES_M
from sailenv_ros.assets.outside.scenery import GROUND_M
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.scene.spec_room import RoomSpec
from sailenv_ros.types.model import Asset
from sailenv_ros.world.world import World
from tests.support.built_world import built_world
from tests.support.divided_bed import write_bed_pack

DAY = Daylight(
    towards_sun=(0.48, -0.6, 0.64),
    sun=(8.0, 7.4, 6.6),
    zenith=(0.2, 0.4, 0.8),
    horizon=(0.8, 0.85, 0.9),
    ground=(0.3, 0.3, 0.25),
)
WINDOW = {"type": "window", "wall": "east", "at": 0.2}
DOOR = {"type": "door", "wall": "south", "at": -0.5}
MOST_TRIANGLES = 4000


def room(*openings: dict[str, Any], outside: Any = "street") -> RoomSpec:
    keys = {"size": [4.0, 3.0, 2.5], "openings": list(openings), "outside": outside}
    return RoomSpec.model_validate(keys)


def made(*openings: dict[str, Any], outside: Any = "street") -> Asset:
    asset = outside_asset(room(*openings, outside=outside), DAY)
    assert asset is not None
    return asset


def positions(asset: Asset) -> np.ndarray[Any, np.dtype[np.float32]]:
    return np.concatenate([part.mesh.positions for part in asset.model.parts])


@pytest.mark.parametrize("kind", ["street", "garden"])
def test_it_is_small_and_follows_from_its_seed(kind: str) -> None:
    first = made(WINDOW, outside={"kind": kind, "seed": 3})
    other = outside_asset(room(WINDOW, DOOR, outside={"kind": kind, "seed": 3}), DAY)
    assert other is first, "a closed door shows nothing, so it is the same"
    _made.cache_clear()
    again = made(WINDOW, outside={"kind": kind, "seed": 3})
    assert np.array_equal(positions(first), positions(again))
    for one, same in zip(first.model.parts, again.model.parts, strict=True):
        texture, again_texture = (p.material.base_colour_texture for p in (one, same))
        assert texture is not None
        assert again_texture is not None
        assert np.array_equal(texture, again_texture)
    assert 200 < first.model.triangle_count < MOST_TRIANGLES
    assert not first.collision
    changed = made(WINDOW, outside={"kind": kind, "seed": 4})
    assert not np.array_equal(positions(first), positions(changed))


def test_houses_stand_opposite_the_largest_windows() -> None:
    """Their front is a plane at its distance from the wall, whichever wall that is."""
    for wall, axis, sign, half in (
        ("north", 1, 1, 1.5), ("east", 0, 1, 2.0), ("south", 1, -1, 1.5), ("west", 0, -1, 2.0),
    ):  # fmt: skip
        points = positions(made({"type": "window", "wall": wall}))
        front = half + 0.2 + HOUSES_M
        on_it = np.abs(sign * points[:, axis] - front) < 1e-5
        assert on_it.sum() >= 8, wall
        assert points[on_it, 2].max() > GROUND_M + 5.0


def test_nothing_of_it_reaches_into_the_room() -> None:
    """No corner lies within the walls; the ground runs on below the floor."""
    hinged = {**DOOR, "hinged": True}
    points = positions(made(WINDOW, hinged))
    inside = (np.abs(points[:, 0]) < 2.199) & (np.abs(points[:, 1]) < 1.699)
    assert not (inside & (points[:, 2] > -0.21)).any()


def test_a_door_that_may_be_opened_leads_into_a_corridor() -> None:
    asset = made({**DOOR, "open": 80})
    points = positions(asset)
    low, high = points.min(axis=0), points.max(axis=0)
    np.testing.assert_allclose(low, (-2.0, -1.5 - 0.2 - 0.002 - 1.5, 0.0), atol=1e-5)
    np.testing.assert_allclose(high, (2.0, -1.5 - 0.2 - 0.002, 2.5), atol=1e-5)
    for part in asset.model.parts:
        a, b, c = (part.mesh.positions[part.mesh.triangles[:, k]] for k in range(3))
        middle = np.array([0.0, -2.45, 1.25])
        facing = np.cross(b - a, c - a)
        assert ((middle - a) * facing).sum(axis=1).min() > 0.0, "all look into it"


def test_a_door_beside_a_window_leads_out() -> None:
    """The window's view would end at the corridor's side."""
    window = {"type": "window", "wall": "south", "at": 1.0, "width": 0.8}
    open_door = {**DOOR, "open": 80}
    points = positions(made(window, open_door))
    assert points[:, 1].min() < -10.0
    assert not (np.abs(points[:, 1] + 1.7 + 0.002) < 1e-4).any()


@pytest.mark.parametrize("openings", [(), (DOOR,)])
def test_where_nothing_can_be_seen_nothing_is_made(openings: tuple[dict[str, Any], ...]) -> None:
    assert outside_asset(room(*openings), DAY) is None


def test_none_is_nothing() -> None:
    assert outside_asset(room(WINDOW, outside="none"), DAY) is None


def test_what_the_sun_does_not_reach_is_darker() -> None:
    """By day a white front in the sun is brighter than under a sky without sun."""
    overcast = Daylight(
        towards_sun=(0.0, 0.0, 1.0), sun=(0.0,) * 3, zenith=DAY.zenith, horizon=DAY.horizon,
        ground=DAY.ground,
    )  # fmt: skip
    dull = outside_asset(room(WINDOW), overcast)
    assert dull is not None
    bright = max(made(WINDOW).model.parts[0].material.emission)
    assert bright > 1.3 * max(dull.model.parts[0].material.emission)


SCENE: dict[str, Any] = {
    "version": 1,
    "room": {
        "size": [4.0, 3.0, 2.5],
        "openings": [WINDOW, {**DOOR, "hinged": True}],
    },
    "lights": [{"name": "sun", "type": "directional", "direction": [-1, 0.2, -1]}],
    "objects": [
        {"name": "bed", "asset": "test_bed"},
        {"name": "ball", "asset": "sphere", "scale": 0.2, "position": [1.5, 0, 0.6]},
    ],
}


def world_of(folder: Path, outside: str | None) -> World:
    write_bed_pack(folder)
    scene = {**SCENE, "room": {**SCENE["room"], **({"outside": outside} if outside else {})}}
    return built_world(scene, AssetLibrary([Primitives(), AssetPack(folder)]))


def test_ids_of_all_else_and_the_bake_stay_as_they_are(tmp_path: Path) -> None:
    """Ids, also of parts of models and of leaves; it comes last, with a category of its own."""
    plain, seen = world_of(tmp_path, None), world_of(tmp_path, "garden")
    before = [d.instance for d in plain.contents.instances]
    after = [d.instance for d in seen.contents.instances]
    assert [(i.id, i.name, i.category_id) for i in after[:-1]] == [
        (i.id, i.name, i.category_id) for i in before
    ]
    last = after[-1]
    assert (last.id, last.name, last.category, last.static) == (
        before[-1].id + 1, "outside", "outside", True,
    )  # fmt: skip
    assert fingerprint(plain.snapshot()) == fingerprint(seen.snapshot())
    plain.close()
    seen.close()


def test_physics_does_not_know_it(tmp_path: Path) -> None:
    """A ball falls, rolls and rests by the same bits."""
    plain, seen = world_of(tmp_path, "none"), world_of(tmp_path, "street")
    for _ in range(4):
        plain.step(60)
        seen.step(60)
        one, other = plain.snapshot().world_from_body, seen.snapshot().world_from_body
        np.testing.assert_array_equal(one, other[:-1])
    plain.close()
    seen.close()


def test_ids_of_instances_ascend(tmp_path: Path) -> None:
    seen = world_of(tmp_path, "street")
    ids = [d.instance.id for d in seen.contents.instances]
    assert all(a < b for a, b in pairwise(ids))
    seen.close()
