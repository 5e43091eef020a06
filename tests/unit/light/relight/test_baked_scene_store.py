"""A room is made ready once for all who show it in the same light, and looks like its own."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.baked_scene_store import BakedSceneStore
from sailenv_ros.light.relight.relighter import Relighter
from tests.support.bake_scenes import ground
from tests.support.movable_boxes import FLOOR, LAMP, WHITE_SKY, room, scene_of
from tests.support.tiny_scenes import Thing, snapshot_of


def assert_same(first: BakedScene, second: BakedScene) -> None:
    """All that relighting reads of them."""
    for name in ("places", "positions", "owners", "irradiance", "direct", "sent", "sky"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name), name)
    np.testing.assert_array_equal(first.patches.albedo, second.patches.albedo)


def test_the_same_room_is_made_ready_once() -> None:
    """Whoever shows it, and whatever is seen outside."""
    store, snapshot = BakedSceneStore(), room(lights=(LAMP,))
    contents = snapshot.contents
    first = store.scene_of(contents, 1)
    assert_same(first, scene_of(snapshot))
    again = store.scene_of(replace(contents, instances=tuple(contents.instances)), 1)
    assert again.patches is first.patches
    assert_same(again, first)
    outside = store.scene_of(replace(contents, environment=WHITE_SKY), 1)
    assert outside.patches is first.patches
    assert outside.sky.max() == np.float32(0.8)
    assert first.sky.max() == 0.0


def test_texels_that_were_kept_are_those_that_are_laid_out(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of a bake that lies on disk; another bake has others."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    snapshot = room(lights=(LAMP,))
    contents = snapshot.contents
    assert contents.baked is not None
    for checksum, files in (("one", 1), ("one", 1), ("another", 2)):
        baked = replace(contents.baked, checksum=checksum)
        scene = BakedScene(baked, replace(contents, baked=baked), 1)
        assert len(list((tmp_path / "arrays").glob("texels-*"))) == files
        assert_same(scene, scene_of(snapshot))
        np.testing.assert_array_equal(scene.normals, scene_of(snapshot).normals)


def test_another_light_or_another_look_is_another_scene() -> None:
    """Each is as if it was the only one."""
    store, snapshot = BakedSceneStore(), room()
    store.scene_of(snapshot.contents, 1)
    other = room(lights=(LAMP,))
    assert_same(store.scene_of(other.contents, 1), scene_of(other))
    white = snapshot_of([Thing(ground(2.0))]).contents.instances[0].model
    assert white is not FLOOR
    painted = tuple(replace(one, model=white) for one in other.contents.instances)
    contents = replace(other.contents, instances=painted)
    scene = store.scene_of(contents, 1)
    assert_same(scene, scene_of(replace(other, contents=contents)))
    assert scene.patches.albedo.max() > 0.5


def test_a_scene_that_is_shown_no_more_is_freed() -> None:
    """With its models, as soon as another one is shown, though that needs no relighting."""
    store, snapshot = BakedSceneStore(), room()
    kept = weakref.ref(store.scene_of(snapshot.contents, 1))
    Relighter(store).watch(snapshot)
    assert kept() is not None
    Relighter(store).watch(snapshot_of([Thing(FLOOR)]))
    gc.collect()
    assert kept() is None
