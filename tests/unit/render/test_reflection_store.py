"""What a room mirrors, kept for when an equal room is shown again."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros.native.light_maps import blur_directions
from sailenv_ros.render.scene.lightmap_compositing import sum_texels
from sailenv_ros.render.scene.mirrored_lamps import Seen
from sailenv_ros.render.scene.reflection_store import MOST_SHARES, ReflectionStore, room_key
from sailenv_ros.render.scene.room_reflections import RoomReflections, Share
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.baked import baked
from tests.support.tiny_scenes import Thing, box_mesh, model_of, snapshot_of

LIGHT = baked({}, [])
POINTS = np.zeros((1, 3))
STILL = np.ones(1, np.bool_)


def box(**material: Any) -> Model:
    return model_of(box_mesh((0.2, 0.2, 0.2)), **material)


def room(model: Model, light: BakedLight = LIGHT, lights: tuple[Light, ...] = ()) -> WorldSnapshot:
    return snapshot_of([Thing(model, Pose((1.0, 2.0, 0.5)))], lights=lights, baked=light)


def everywhere(camera: Camera, value: float) -> Seen:
    """A picture of one radiance, far away."""
    size = camera.intrinsics.height, camera.intrinsics.width
    return Seen(np.full((*size, 3), value, np.float32), np.full(size, np.inf, np.float32))


def test_equal_rooms_have_equal_keys() -> None:
    """A room that is built again has models of its own."""
    keys = {room_key(room(box(roughness=0.3)), STILL, POINTS) for _ in range(2)}
    assert len(keys) == 1


@pytest.mark.parametrize(
    "other",
    [
        room(box(roughness=0.31)), room(box(roughness=0.3, metallic=1.0)),
        room(box(roughness=0.3, base_colour=(0.1, 0.8, 0.8, 1.0))),
        room(box(roughness=0.3, normal_texture=np.zeros((4, 4, 4), np.uint8))),
        room(model_of(box_mesh((0.2, 0.2, 0.3)), roughness=0.3)),
        room(box(roughness=0.3), baked({}, [])),
    ],
)  # fmt: skip
def test_other_rooms_have_other_keys(other: WorldSnapshot) -> None:
    """Of another material, shape or light."""
    one = room_key(room(box(roughness=0.3)), STILL, POINTS)
    assert room_key(other, STILL, POINTS) != one
    assert room_key(room(box(roughness=0.3)), STILL, POINTS + 1.0) != one
    assert room_key(room(box(roughness=0.3)), ~STILL, POINTS) != one


def test_a_room_that_is_shown_again_is_not_looked_at_again() -> None:
    """By another renderer, too; with another light only under that one."""
    looked: list[Light | None] = []

    def look(light: Light | None, views: list[tuple[Camera, bool]]) -> list[Seen]:
        looked.append(light)
        value = 1.0 if light is None else 2.0
        return [everywhere(one, value) for one, _ in views]

    def shown(snapshot: WorldSnapshot, store: ReflectionStore[Share] | None) -> RoomReflections:
        made = RoomReflections(partial(blur_directions, threads=1), sum_texels, store)
        made.update(snapshot, STILL, None, look)
        return made

    store: ReflectionStore[Share] = ReflectionStore()
    lamp = Light(name="lamp", type="point", position_m=(0.0, 0.0, 1.0))
    first = shown(room(box()), store)
    assert looked == [None]
    again, anew = shown(room(box()), store), shown(room(box()), None)
    assert looked == [None, None]
    assert np.array_equal(first.layers, again.layers)
    assert np.array_equal(again.layers, anew.layers)
    lit = shown(room(box(), lights=(lamp,)), store)
    assert [one is None for one in looked] == [True, True, False]
    brighter = replace(lamp, intensity=3.0)
    assert shown(room(box(), lights=(brighter,)), store).layers.max() > lit.layers.max()
    assert len(looked) == 3


def test_light_that_is_refined_soon_mirrors_what_was_mirrored() -> None:
    """A move's own frame looks at nothing again; the refined one does."""
    looked: list[Light | None] = []

    def look(light: Light | None, views: list[tuple[Camera, bool]]) -> list[Seen]:
        looked.append(light)
        return [everywhere(one, 1.0) for one, _ in views]

    shown = RoomReflections(partial(blur_directions, threads=1), sum_texels)
    for number, (rough, expected) in enumerate([(True, 1), (True, 1), (False, 2), (True, 2)]):
        light = replace(baked({}, []), rough=rough)
        shown.update(room(box(), light), STILL, None, look)
        assert len(looked) == expected, number


@pytest.mark.parametrize("checksum", ["", "of the light's file"])
def test_shares_of_light_as_it_was_baked_are_kept_on_disk(
    checksum: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By another process, too; not those of light that was changed, nor for another renderer."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    looked: list[Light | None] = []
    rng = np.random.default_rng(5)

    def look(light: Light | None, views: list[tuple[Camera, bool]]) -> list[Seen]:
        looked.append(light)
        return [everywhere(one, float(rng.random())) for one, _ in views]

    def shown(drawn_by: str) -> RoomReflections:
        made = RoomReflections(partial(blur_directions, threads=1), sum_texels, drawn_by=drawn_by)
        lamp = Light(name="lamp", type="point", position_m=(0.0, 0.0, 1.0))
        light = replace(baked({}, []), checksum=checksum)
        made.update(room(box(), light, (lamp,)), STILL, None, look)
        return made

    first, again, other = shown("kernels"), shown("kernels"), shown("other kernels")
    assert len(looked) == (4 if checksum else 6)
    assert np.array_equal(first.layers, again.layers) == bool(checksum)
    assert np.array_equal(first.around, again.around) == bool(checksum)
    assert not np.array_equal(first.layers, other.layers)
    assert shown("").layers.tobytes() != first.layers.tobytes()


def test_a_store_is_bounded() -> None:
    store: ReflectionStore[int] = ReflectionStore()
    for number in range(MOST_SHARES + 1):
        store.put(number, number, room(box()))
        store.get(0)
    assert [store.get(number) for number in (0, 1, 2)] == [0, None, 2]
