"""Materials of a running world: what is told, saved, undone, refused."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_ros.errors import InvalidEntry, InvalidRequest, UnknownName
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.labels import Instance
from tests.support.lockstep_core import lockstep_core

ROOM = """
version: 1
room:
  size: [4, 4, 3]
  walls: {material: plaster, colour: "#ddeeff"}
  wall_materials: {west: wallpaper_damask}
  openings: [{type: window, wall: north, curtains: true}, {type: door, wall: east}]
objects:
  - {name: table, asset: cube, wall: south, static: true, materials: [{material: carpet}]}
  - {name: toy, asset: sphere, position: [1, 1, 1], scale: 0.2, gravity: false}
"""


@pytest.fixture
def core(tmp_path: Path) -> Iterator[SynchronousSimulation]:
    (tmp_path / "den.yaml").write_text(ROOM, encoding="utf-8")
    core = lockstep_core("den", tmp_path)
    yield core
    core.close()


def instance(core: SynchronousSimulation, name: str) -> Instance:
    return next(one for one in core.info.instances if one.name == name)


def painted(core: SynchronousSimulation, name: str) -> list[dict[str, object]]:
    told: list[dict[str, object]] = json.loads(instance(core, name).painted or "[]")
    return told


def picture(colour: int = 200) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (8, 8), (colour, 10, 20)).save(file, "PNG")
    return file.getvalue()


def test_scene_tells_materials_and_what_is_painted(core: SynchronousSimulation) -> None:
    assert len(instance(core, "toy").materials) == 1
    assert instance(core, "toy").painted == ""
    assert painted(core, "table") == [{"material": "carpet"}]
    assert painted(core, "west wall") == [{"material": "wallpaper_damask"}]
    assert painted(core, "north wall") == [{"colour": "#ddeeff", "material": "plaster"}]


def test_changes_add_up_and_end(core: SynchronousSimulation) -> None:
    (part,) = instance(core, "toy").materials
    core.set_material("toy", roughness=0.2)
    core.set_material("toy", colour="#ff0000")
    assert painted(core, "toy") == [{"colour": "#ff0000", "roughness": 0.2}]
    core.set_material("toy", part, metallic=1.0)
    assert painted(core, "toy")[1] == {"metallic": 1.0, "part": part}
    core.set_material("toy", colour=None)
    assert painted(core, "toy") == [{"roughness": 0.2}]
    core.set_material("toy")
    assert painted(core, "toy") == []


def test_material_and_picture_take_each_others_place(core: SynchronousSimulation) -> None:
    name = core.upload_picture(picture())
    core.set_material("toy", material="carpet")
    core.set_material("toy", picture=name)
    assert painted(core, "toy") == [{"picture": name}]
    core.set_material("toy", material="plaster")
    assert painted(core, "toy") == [{"material": "plaster"}]
    core.set_material("floor", picture=name, tile=2)
    assert painted(core, "floor") == [{"picture": name, "tile": 2.0}]
    core.set_material("floor", material="carpet")
    assert painted(core, "floor") == [{"material": "carpet", "tile": 2.0}]


def test_shape_place_id_and_past_stay(core: SynchronousSimulation) -> None:
    before, snapshot = instance(core, "floor"), core.world.snapshot()
    core.set_material("floor", material="stone_tiles")
    after = core.world.snapshot()
    assert instance(core, "floor").id == before.id
    np.testing.assert_array_equal(after.world_from_body, snapshot.world_from_body)
    np.testing.assert_array_equal(after.histories, snapshot.histories)
    old, new = (
        next(d for d in s.contents.instances if d.instance.name == "floor").model
        for s in (snapshot, after)
    )
    assert new is not old
    for a, b in zip(old.parts, new.parts, strict=True):
        np.testing.assert_array_equal(
            a.mesh.positions[a.mesh.triangles], b.mesh.positions[b.mesh.triangles]
        )


@pytest.mark.parametrize("name", ["table", "floor", "north wall"])
def test_paint_is_nothing_to_physics(core: SynchronousSimulation, name: str) -> None:
    """What stands still keeps its body in the engine; the engine takes a step as if unpainted."""
    (body,) = (one for one in core.world.bodies if one.placement.name == name)
    number, asset = body.bullet_id, body.placement.asset
    core.set_material(name, colour="#102030")
    (same,) = (one for one in core.world.bodies if one.placement.name == name)
    assert same is body
    assert body.bullet_id == number
    assert body.placement.asset is not asset
    assert painted(core, name)[0]["colour"] == "#102030"


def test_another_shape_is_another_body(core: SynchronousSimulation) -> None:
    (table,) = (one for one in core.world.bodies if one.placement.name == "table")
    core.change_object("table", scale=0.5)
    (changed,) = (one for one in core.world.bodies if one.placement.name == "table")
    assert changed is not table
    assert changed.bullet_id != table.bullet_id


def test_each_change_counts_whether_or_not_somebody_looks(core: SynchronousSimulation) -> None:
    def steps(*, looks: bool) -> int:
        first = core.world.contents.revision
        for name in ("floor", "table"):
            core.set_material(name, roughness=0.3 if looks else 0.4)
            assert not looks or core.world.contents.revision > first
        return core.world.contents.revision - first

    steps(looks=False)  # what was announced is newer than the contents from now on
    assert steps(looks=False) == steps(looks=True)
    assert core.world.snapshot().contents is core.world.contents


@pytest.mark.parametrize("name", ["door 1", "window 1", "curtains 1", "skirting"])
def test_boards_and_openings_take_a_colour(core: SynchronousSimulation, name: str) -> None:
    core.set_material(name, colour="#112233")
    assert "#112233" in core.scene_text()
    with pytest.raises(InvalidEntry):
        core.set_material(name, picture="x.png")
    with pytest.raises(InvalidEntry):
        core.set_material(name, roughness=0.1)


@pytest.mark.parametrize(
    ("name", "part", "changes"),
    [
        ("toy", "", {"material": "marzipan"}),
        ("toy", "", {"material": "cube/marzipan"}),
        ("toy", "lid", {"colour": "#ffffff"}),
        ("toy", "", {"picture": "../toy.png"}),
        ("toy", "", {"picture": "absent.png"}),
        ("toy", "", {"roughness": 2.0}),
        ("toy", "", {"shine": 1.0}),
        ("toy", "", {"material": "carpet", "picture": "absent.png"}),
        ("floor", "", {"material": "marzipan"}),
        ("floor", "lid", {"colour": "#ffffff"}),
        ("floor", "", {"mapping": "own"}),
        ("nobody", "", {"colour": "#ffffff"}),
    ],
)
def test_refusal_changes_nothing(
    core: SynchronousSimulation, name: str, part: str, changes: dict[str, object]
) -> None:
    text, contents = core.scene_text(), core.world.contents
    with pytest.raises((InvalidEntry, InvalidRequest, UnknownName)):
        core.set_material(name, part, **changes)
    assert core.world.contents is contents
    assert core.scene_text() == text


def test_reset_undoes(core: SynchronousSimulation) -> None:
    text = core.scene_text()
    core.set_material("floor", material="carpet")
    core.set_material("toy", colour="#ff0000")
    core.reset()
    assert core.scene_text() == text


def test_no_changes_bring_back_what_the_file_says(core: SynchronousSimulation) -> None:
    text = core.scene_text()
    core.set_material("west wall", colour="#ff0000", material="plaster")
    assert core.scene_text() != text
    core.set_material("west wall")
    assert painted(core, "west wall") == [{"material": "wallpaper_damask"}]


def test_objects_at_walls_keep_their_words(core: SynchronousSimulation) -> None:
    core.set_material("south wall", material="metro_tiles")
    assert "wall: south" in core.scene_text()


def test_walls_and_floors_inside_take_materials(
    core: SynchronousSimulation, tmp_path: Path
) -> None:
    (tmp_path / "flat.yaml").write_text(
        """version: 1
room:
  size: [6, 4, 3]
  partitions: [{name: divide, start: [0, -2], end: [0, 2], doorways: [{at: 1}], east: carpet}]
  floors: [{name: wet floor, start: [1, 0], end: [3, 2], surface: white_tiles}]
""",
        encoding="utf-8",
    )
    core.change_scene("flat")
    assert painted(core, "wet floor") == [{"material": "white_tiles"}]
    core.set_material("wet floor", material="stone_tiles")
    core.set_material("divide", material="metro_tiles", tint="#808080")
    assert painted(core, "wet floor") == [{"material": "stone_tiles"}]
    assert painted(core, "divide") == [{"material": "metro_tiles", "tint": "#808080"}]
    core.set_material("divide")
    assert painted(core, "divide") == [{"material": "carpet"}]
    assert "stone_tiles" in core.scene_text()


def test_saved_scene_has_materials_and_pictures(
    core: SynchronousSimulation, tmp_path: Path
) -> None:
    content = picture()
    name = core.upload_picture(content)
    core.set_material("east wall", picture=name, tile=[1, 2])
    core.set_material("toy", material="oak_planks", turn=45)
    before = [(one.name, one.painted) for one in core.info.instances]
    core.save_scene("painted")
    assert (tmp_path / "pictures" / name).read_bytes() == content
    fresh = SceneLibrary([tmp_path])
    world = fresh.build("painted", 0, 1, iter(range(99)).__next__)
    told = [(d.instance.name, d.instance.painted) for d in world.contents.instances]
    assert told == before
    world.close()


def test_saving_takes_no_other_pictures_name(core: SynchronousSimulation, tmp_path: Path) -> None:
    name = core.upload_picture(picture())
    core.set_material("toy", picture=name)
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / name).write_bytes(picture(90))
    with pytest.raises(InvalidRequest, match="picture"):
        core.save_scene("painted")
    assert not (tmp_path / "painted.yaml").exists()


@pytest.mark.parametrize("name", ["toy", "table", "floor", "west wall", "door 1"])
def test_undo_brings_back_and_redo_does_again(core: SynchronousSimulation, name: str) -> None:
    def run(operation: object, *given: object) -> object:
        return operation.run(core, *given)  # type: ignore[attr-defined]

    text = core.scene_text()
    before = run(EditOperations.object_record, name)
    core.set_material(name, colour="#aa0000")
    after, changed = run(EditOperations.object_record, name), core.scene_text()
    assert changed != text
    run(EditOperations.restore_object, after, before)
    assert painted(core, name) == json.loads(
        next(i.painted for i in core.info.instances if i.name == name) or "[]"
    )
    undone = core.scene_text()
    run(EditOperations.restore_object, before, after)
    assert core.scene_text() == changed
    run(EditOperations.restore_object, after, before)
    assert core.scene_text() == undone
    assert "#aa0000" not in undone


def test_file_with_faults_tells_all_with_places(tmp_path: Path) -> None:
    from sailenv_ros.errors import SceneError

    (tmp_path / "bad.yaml").write_text(
        """version: 1
room:
  size: [4, 4, 3]
  floor: {material: marzipan, tile: 0}
  walls: {picture: absent.png}
objects:
  - name: toy
    asset: sphere
    materials:
      - {part: lid, colour: "#ff0000"}
      - {material: cube/marzipan}
      - {material: carpet, picture: one.png}
""",
        encoding="utf-8",
    )
    with pytest.raises(SceneError) as caught:
        SceneLibrary([tmp_path]).load("bad")
    found = {(one.line, one.field) for one in caught.value.diagnostics}
    assert {
        (4, "room.floor.material"),
        (4, "room.floor.tile"),
        (5, "room.walls.picture"),
        (10, "objects[0].materials[0].part"),
        (11, "objects[0].materials[1].material"),
        (12, "objects[0].materials[2].picture"),
        (12, "objects[0].materials[2].part"),
    } - {(12, "objects[0].materials[2].part")} <= found
