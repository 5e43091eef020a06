"""Textures of the native renderer: those of a room that was left do not stay beside the next's."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.cpu.texture_store import SPARE_BYTES, TextureStore
from sailenv_ros.types.model import Material, Model
from sailenv_ros.types.snapshot import SceneContents
from tests.support.tiny_scenes import Thing, box_mesh, contents_of, model_of

LARGE_PX, LARGE_BYTES = 1024, 5.6e6


class _WatchedTextures(TextureStore):
    """Tells how much there was before and after new ones were made."""

    def __init__(self) -> None:
        super().__init__()
        self.held: list[tuple[float, float]] = []

    @property
    def bytes(self) -> float:
        """Of all textures that are there."""
        return float(sum(chain.nbytes for _, chain, _ in self._textures.values()))

    def prepare(self, materials: Iterable[Material]) -> None:
        """Note memory before and after."""
        before = self.bytes
        super().prepare(materials)
        self.held.append((before, self.bytes))


def textured(edge_px: int) -> Model:
    """Return a box with a colour map of its own."""
    texture = np.full((edge_px, edge_px, 4), 200, np.uint8)
    return model_of(box_mesh(1.0), base_colour_texture=texture)


def room(*models: Model) -> SceneContents:
    """Return what is in a room with these things."""
    return contents_of([Thing(model) for model in models])


def test_textures_of_a_room_that_was_left_go_before_the_next_ones_are_made() -> None:
    """Two rooms of four large textures that share one: never are there more than five."""
    shared = textured(LARGE_PX)
    rooms = [room(shared, *(textured(LARGE_PX) for _ in range(3))) for _ in range(2)]
    textures = _WatchedTextures()
    table = PartTable(textures=textures)
    for contents in (*rooms, rooms[0]):
        table.show(contents)
    before, after = np.transpose(textures.held) / LARGE_BYTES
    np.testing.assert_allclose(before, [0.0, 1.0, 1.0], atol=0.1)
    np.testing.assert_allclose(after, 4.0, atol=0.1)


def test_an_object_that_comes_again_finds_its_texture() -> None:
    """What is not shown stays as long as it is little; the addresses in tables stay right."""
    wall, ball = textured(LARGE_PX), textured(128)
    textures = _WatchedTextures()
    table = PartTable(textures=textures)
    places = []
    for contents in (room(wall, ball), room(wall), room(wall, ball)):
        table.show(contents)
        places.append(table.opaque["colour_map_at"].tolist())
    assert places[1] == places[0][:1]
    assert places[2] == places[0]
    assert textures.bytes < LARGE_BYTES + SPARE_BYTES
    assert 0 not in places[0]


def test_what_is_kept_beside_the_room_has_a_limit() -> None:
    """Things come one after another."""
    wall = textured(128)
    textures = _WatchedTextures()
    table = PartTable(textures=textures)
    for _ in range(8):
        table.show(room(wall, textured(LARGE_PX)))
        assert textures.bytes < 1.1 * LARGE_BYTES + SPARE_BYTES
