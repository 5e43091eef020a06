"""Parts of one asset's model: instances of their own that go with the body."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.errors import AssetError, InvalidRequest, NameTaken, UnknownName
from sailenv_ros.simulation.recorded_geometry import recorded_geometry
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.simulation import Simulation
from sailenv_ros.types.model import AssetPart
from tests.support.divided_bed import LEFT, RIGHT, divided_bed, write_bed_pack


@pytest.fixture
def pack(tmp_path: Path) -> AssetPack:
    write_bed_pack(tmp_path)
    return AssetPack(tmp_path)


def test_a_body_is_drawn_without_its_parts() -> None:
    asset = divided_bed()
    assert len(asset.body_model.parts) == 1
    assert asset.body_model.bounds()[1, 2] == pytest.approx(0.4)
    assert asset.body_model is asset.body_model  # renderers compare models by identity
    assert asset.part_model(asset.parts[0]) is asset.part_model(asset.parts[0])
    assert asset.part_model(asset.parts[0]).bounds()[0, 1] == pytest.approx(0.1)
    plain = divided_bed(())
    assert plain.body_model is plain.model


@pytest.mark.parametrize(
    ("meshes", "why"),
    [(((1,), (1,)), "two of its parts"), (((0,), (1, 2)), "left to the body"), (((),), "no mesh")],
)
def test_parts_share_no_mesh_and_leave_one(meshes: tuple[tuple[int, ...], ...], why: str) -> None:
    parts = (
        AssetPart(name=f"part {n}", category="pillow", meshes=own) for n, own in enumerate(meshes)
    )
    with pytest.raises(AssetError, match=why):
        divided_bed(tuple(parts))


def test_a_pack_keeps_parts(pack: AssetPack) -> None:
    asset = pack.load("test_bed")
    assert [(part.name, part.category) for part in asset.parts] == [
        (LEFT, "pillow"),
        (RIGHT, "pillow"),
    ]
    for part, wanted in zip(asset.parts, divided_bed().parts, strict=True):
        own, other = asset.part_model(part), divided_bed().part_model(wanted)
        np.testing.assert_allclose(own.bounds(), other.bounds(), atol=1e-6)


def test_parts_are_named_by_mesh_node_or_material(pack: AssetPack) -> None:
    file = pack.folder / "pack.yaml"
    content = yaml.safe_load(file.read_text())
    content["assets"][0]["parts"] = {"pillows": {"category": "pillow", "materials": ["cot*"]}}
    file.write_text(yaml.safe_dump(content))
    asset = AssetPack(pack.folder).load("test_bed")
    assert [(part.name, len(part.meshes)) for part in asset.parts] == [("pillows", 2)]
    assert asset.body_model.bounds()[1, 2] == pytest.approx(0.4)
    content["assets"][0]["parts"] = {"lid": {"category": "pillow", "meshes": ["lid"]}}
    file.write_text(yaml.safe_dump(content))
    with pytest.raises(AssetError, match=r"no mesh of test_bed\.glb is of its part 'lid'"):
        AssetPack(pack.folder).load("test_bed")
    content["assets"][0]["parts"] = {"lid": {"category": "pillow"}}
    file.write_text(yaml.safe_dump(content))
    with pytest.raises(AssetError, match="needs meshes or materials"):
        AssetPack(pack.folder)


def test_a_library_tells_what_is_drawn(pack: AssetPack) -> None:
    library = AssetLibrary([Primitives(), pack])
    asset = library.get("test_bed")
    assert library.drawn_model("test_bed") is asset.body_model
    assert library.drawn_model(f"test_bed/{LEFT}") is asset.part_model(asset.parts[0])
    with pytest.raises(UnknownName, match="part of 'test_bed'"):
        library.drawn_model("test_bed/lid")


@pytest.fixture
def room(pack: AssetPack, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SAILENV_PACKS", str(pack.folder))
    monkeypatch.setenv("SAILENV_SCENES", str(tmp_path))
    file = tmp_path / "sleep.yaml"
    objects = [
        {"name": "floor", "asset": "plane", "category": "floor", "static": True},
        {"name": "bed", "asset": "test_bed", "position": [0.0, 0.0, 0.001]},
        {"name": "ball", "asset": "sphere", "position": [3.0, 0.0, 0.5], "static": True},
        {
            "name": "cot",
            "asset": "test_bed",
            "position": [0, 5, 0],
            "scale": 0.5,
            "part_of": "ball",
        },
    ]
    agents = [
        {
            "name": "eye",
            "width": 160,
            "height": 120,
            "following": False,
            "position": [0, 0, 5],
            "rotation": [0, 90, 0],
        }
    ]
    file.write_text(yaml.safe_dump({"version": 1, "objects": objects, "agents": agents}))
    return file


def test_parts_in_a_scene(room: Path) -> None:
    with Simulation(room, mode="lockstep", backend="native") as simulation:
        frame = simulation.capture(agent="eye")
        table = frame.objects
        # Bodies come first, so that parts of one object change no other's number.
        assert table.names == (
            "floor", "bed", "ball", "cot",
            f"bed/{LEFT}", f"bed/{RIGHT}", f"cot/{LEFT}", f"cot/{RIGHT}",
        )  # fmt: skip
        assert table.ids.tolist() == list(range(1, 9))
        assert table.parents.tolist() == [0, 0, 0, 3, 2, 2, 4, 4]
        assert table.categories[4:] == ("pillow",) * 4
        assert table.assets[4] == f"test_bed/{LEFT}"
        seen = {name: int(n) for name, n in zip(table.names, table.visible_pixels, strict=True)}
        assert seen[f"bed/{LEFT}"] > 50
        category = {c.name: c.id for c in simulation.info.categories.values()}["pillow"]
        np.testing.assert_array_equal(
            frame["category"] == category, np.isin(frame["instance"], (5, 6, 7, 8))
        )
        # Alone, the bed covers what its pillows hide, and the pillows what they show.
        masks = frame.amodal
        assert masks.mask(2)[frame["instance"] == 5].all()
        np.testing.assert_array_equal(masks.mask(5), frame["instance"] == 5)
        np.testing.assert_allclose(table.box_sizes[4], [0.4, 0.6, 0.1], atol=1e-6)
        np.testing.assert_allclose(table.box_sizes[6], [0.2, 0.3, 0.05], atol=1e-6)
        np.testing.assert_array_equal(table.world_from_object[4], table.world_from_object[1])
        assert frame.states is not None
        geometry = recorded_geometry(simulation.info, SceneLibrary())
        hits = geometry.cast(frame.states, [[-0.7, 0.4, 5.0]], [[0.0, 0.0, -1.0]])
        assert hits.instance.tolist() == [5]


def test_parts_go_with_their_body(room: Path) -> None:
    with Simulation(room, mode="lockstep", backend="native") as simulation:
        before = simulation.capture(agent="eye")
        simulation.move_object("bed", position=(0.1, 0.0, 0.001))
        simulation.step(1)
        after = simulation.capture(agent="eye")
        # Seen from above, a shift along the world's x goes up the picture by f dx / depth.
        for part in (2, 5, 6):
            seen = after["instance"] == part
            assert seen.any()
            moved = after["flow"][seen].astype(float) * after.dt_s * after["depth"][seen][:, None]
            shift = after.camera.intrinsics.fy * 0.1
            np.testing.assert_allclose(moved, [[0.0, -shift]] * len(moved), atol=0.02 * shift)
        assert before.states is not None
        assert after.states is not None
        for part in (5, 6):
            np.testing.assert_array_equal(
                after.states.matrices[after.states.row(part)],
                after.states.matrices[after.states.row(2)],
            )


def test_what_cannot_be_done_to_a_part_is_refused(room: Path) -> None:
    with Simulation(room, mode="lockstep", backend="native") as simulation:
        for refused in (
            lambda: simulation.despawn_object(5),
            lambda: simulation.move_object(f"bed/{LEFT}", position=(0.0, 0.0, 0.0)),
            lambda: simulation.change_object(5, static=True),
        ):
            with pytest.raises(InvalidRequest, match=f"goes with 'bed', .*'bed/{LEFT}'"):
                refused()
        state = simulation.get_object(f"bed/{LEFT}")
        assert (state.id, state.category, state.asset) == (5, "pillow", f"test_bed/{LEFT}")
        assert state.size_m == pytest.approx((0.4, 0.6, 0.1))
        assert simulation.get_object("bed").size_m == pytest.approx((2.0, 1.6, 0.5))


def test_parts_come_and_leave_with_their_body(room: Path) -> None:
    with Simulation(room, mode="lockstep", backend="native") as simulation:
        spawned = simulation.spawn_object(
            "test_bed", position=(0.0, -5.0, 0.0), object_name="guest"
        )
        ids = {i.name: i.id for i in simulation.info.instances}
        assert (spawned, ids[f"guest/{LEFT}"], ids[f"guest/{RIGHT}"]) == (9, 10, 11)
        with pytest.raises(NameTaken):
            simulation.spawn_object("test_bed", position=(0.0, -9.0, 0.0), object_name="guest")
        simulation.change_object(spawned, colour="#802020", name="visitor")
        renamed = {i.name: i.id for i in simulation.info.instances}
        assert renamed[f"visitor/{LEFT}"] == 10
        simulation.despawn_object(spawned)
        assert max(i.id for i in simulation.info.instances) == 8
        assert simulation.spawn_object("sphere", position=(0.0, 0.0, 9.0)) == 12
