"""Sweet Home 3D files become scenes: places, openings, light and cameras, by arithmetic."""

from __future__ import annotations

import contextlib
import itertools
import zipfile
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sailenv_content.scene_import import imported
from sailenv_content.scene_import.imported import Names
from sailenv_content.scene_import.importers import import_scene
from sailenv_content.scene_import.sweet_home import import_sweet_home
from sailenv_ros import Simulation
from sailenv_ros.assets.pack import PackEntry
from sailenv_ros.cli.main import main
from sailenv_ros.errors import AssetError, InvalidRequest, SailenvError
from tests.support.home_files import CUBE, FLAT, write_home


def entries(scene: Path) -> dict[str, dict[str, object]]:
    data = yaml.safe_load(scene.read_text(encoding="utf-8"))
    return {entry["name"]: entry for entry in data["objects"]}


def test_everything_is_where_it_was_drawn(tmp_path: Path, packs: Path) -> None:
    """Centimetres with y down become metres with y up; fronts look south unless turned."""
    report = import_scene(write_home(tmp_path / "flat.sh3d"), tmp_path / "flat.yaml", packs)
    assert (report.notes, report.ours) == ((), 0)
    found = entries(tmp_path / "flat.yaml")
    chair = found["Chair"]
    assert chair["position"] == [1.5, -1.5, 0]
    assert chair["rotation"] == [0, 0, pytest.approx(-90.0 - np.degrees(0.5), abs=1e-3)]
    assert "Hidden" not in found
    assert found["Lamp"]["position"] == [5, -3.5, 0]
    pack = yaml.safe_load((packs / "pack.yaml").read_text(encoding="utf-8"))
    models = {entry["name"]: entry for entry in pack["assets"]}
    model = models[str(chair["asset"])]
    assert model["size"] == pytest.approx([0.4, 0.5, 0.9])
    assert (model["category"], model["author"], model["licence"]) == ("chair", "somebody", "CC0")
    assert models[str(found["wall"]["asset"])]["category"] == "wall"
    assert {"West floor", "West ceiling", "East floor"} <= found.keys()
    assert "East ceiling" not in found
    data = yaml.safe_load((tmp_path / "flat.yaml").read_text(encoding="utf-8"))
    lights = {light["name"]: light for light in data["lights"]}
    assert lights["Lamp light"]["position"] == pytest.approx([5.0, -3.5, 0.6])
    assert lights["Window sky"]["direction"] == pytest.approx([0, -1, -0.25])
    assert data["mover"]["position"] == [3, -3.6, 1.6]
    assert data["mover"]["rotation"] == pytest.approx([0, np.degrees(0.1), 90], abs=1e-3)
    (agent,) = data["agents"]
    assert agent["rotation"] == pytest.approx([0, 0, 90])
    assert agent["vertical_fov"] == pytest.approx(2 * np.degrees(np.arctan(0.75)), abs=0.01)


def test_rays_pass_where_openings_are(tmp_path: Path, packs: Path) -> None:
    """Through the door between the rooms, not beside it; the scene is built and walked through."""
    without_leaves = FLAT.replace("name='Door' model='0'", "name='Door' model='9'").replace(
        "name='Window' model='0'", "name='Window' model='9'"
    )
    source = write_home(tmp_path / "flat.sh3d", without_leaves)
    report = import_scene(source, tmp_path / "flat.yaml", packs)
    assert len(report.notes) == 2
    assert "left out" in report.notes[0]
    with Simulation(tmp_path / "flat.yaml", mode="lockstep") as simulation:
        names = {i.id: i.category for i in simulation.info.instances}
        cast = simulation.cast_rays(
            [(1.0, -2.0, 1.0), (1.0, -3.0, 1.0), (1.0, -2.0, 2.3), (1.0, -1.0, 1.5), (1, -1, 0.5)],
            [(1, 0, 0), (1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 0)],
        )
        np.testing.assert_allclose(cast.distances_m[:3], [4.9, 1.95, 1.95], atol=1e-4)
        assert np.isinf(cast.distances_m[3])  # out of the window
        assert cast.distances_m[4] == pytest.approx(0.9, abs=1e-4)  # the wall below it
        assert names[int(cast.instance_ids[1])] == "wall"
        space = simulation.free_space(1.8, 0.25)
        assert space.reachable((0.6, -3.4), (5.4, -3.0))
        way = simulation.find_path((0.6, -3.4), (5.4, -3.0))
        a, b = next(pair for pair in itertools.pairwise(way) if pair[0][0] <= 3.0 < pair[1][0])
        crossing = a + (3.0 - a[0]) / (b[0] - a[0]) * (b - a)
        assert -2.2 - 1e-6 <= crossing[1] <= -1.8 + 1e-6


def test_models_of_the_catalogue_are_ours(tmp_path: Path) -> None:
    """By its id, with the scale between the sizes; not if it is mirrored or painted in parts."""
    # bed_01 is BlendSwap-CC-0/bedWithTexture in the recipe.
    bed = PackEntry(
        name="bed_01", display_name="Bed 01", category="bed", file="bed_01.glb",
        size=(2.0, 1.5, 1.0), mass=70.0, triangles=10,
    )  # fmt: skip
    piece = (
        "<pieceOfFurniture name='Bed' catalogId='Blend Swap CC-0#bedWithTexture' model='0' x='0'"
        " y='0' width='{width}' depth='200' height='100' {more}/>"
    )

    def imported(width: float, more: str = "") -> dict[str, object]:
        xml = f"<home>{piece.format(width=width, more=more)}</home>"
        path = write_home(tmp_path / "bed.sh3d", xml)
        scene = import_sweet_home(path, Names("x"), {"bed_01": bed})
        return next(entry for entry in scene.objects if entry["name"] == "Bed")

    assert imported(150) == {
        "name": "Bed", "asset": "bed_01", "position": [0, 0, 0], "rotation": [0, 0, -90],
        "static": True,
    }  # fmt: skip
    assert imported(180)["scale"] == [1.0, 1.2, 1.0]
    assert imported(150, "color='00FF0000'")["colour"] == "#ff0000"
    assert imported(150, "modelMirrored='true'")["asset"] == "x_bed"


def test_round_walls_are_round(tmp_path: Path, packs: Path) -> None:
    """Half a circle of 2 m between two points: its pieces lie on the circle."""
    xml = (
        "<home wallHeight='200'><wall id='a' xStart='0' yStart='0' xEnd='400' yEnd='0'"
        " thickness='10' arcExtent='3.1415927'/></home>"
    )
    import_scene(write_home(tmp_path / "arc.sh3d", xml), tmp_path / "arc.yaml", packs)
    with Simulation(tmp_path / "arc.yaml", mode="lockstep") as simulation:
        a = np.radians(np.linspace(-170, 170, 35))
        cast = simulation.cast_rays((2.0, 0.0, 1.0), np.stack([np.cos(a), np.sin(a), 0 * a], -1))
    met = np.isfinite(cast.distances_m)
    assert 15 <= met.sum() <= 20
    np.testing.assert_allclose(cast.distances_m[met], 1.95, atol=0.03)
    side = np.sign(np.sin(a[met][np.abs(np.sin(a[met])) > 0.1]))
    assert len(set(side.tolist())) == 1


@pytest.mark.parametrize(
    ("xml", "sentence"),
    [
        ("<!DOCTYPE home [<!ENTITY a 'x'>]><home name='&a;'/>", "document type or entities"),
        ("<!DOCTYPE home SYSTEM 'file:///etc/passwd'><home/>", "document type or entities"),
        ("<home", "no XML"),
        ("<house/>", "must begin with <home>"),
        ("<home><wall xStart='nan' xEnd='1'/></home>", "xStart of <wall> must be a number"),
        ("<home><wall xStart='1e300' xEnd='1'/></home>", "xStart of <wall> must be a number"),
        ("<home/>", "nothing that a scene could show|ground"),
        ("<home>" + "<a>" * 100 + "</a>" * 100 + "</home>", "levels"),
        ("<home><room floorColor='red'><point/><point/><point/></room></home>", "must be a colour"),
        (
            "<home><pieceOfFurniture model='0' modelRotation='1 2'/></home>",
            "modelRotation of <pieceOfFurniture> must be 9 finite numbers",
        ),
        (
            "<home>" + "<pieceOfFurniture model='0' width='9' depth='9' height='9'/>" * 51
            + "</home>",
            "more than 50 objects",
        ),
    ],
)  # fmt: skip
def test_malformed_plans_are_refused_and_leave_nothing(
    tmp_path: Path, packs: Path, xml: str, sentence: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One sentence, no scene, no pack, no draft."""
    monkeypatch.setattr(imported, "MOST_OBJECTS", 50)
    source = write_home(tmp_path / "bad.sh3d", xml)
    before = sorted(tmp_path.rglob("*"))
    if xml == "<home/>":
        report = import_scene(source, tmp_path / "bad.yaml", packs)
        assert report.objects == 1  # the ground
        return
    with pytest.raises(AssetError, match=sentence) as caught:
        import_scene(source, tmp_path / "bad.yaml", packs)
    assert "\n" not in str(caught.value)
    assert sorted(tmp_path.rglob("*")) == before


def test_hostile_archives_are_refused(tmp_path: Path, packs: Path) -> None:
    """Paths that lead out, bombs, no plan, no archive at all."""
    cases = {"../evil": b"x", "bomb": b"\0" * (30 << 20)}
    for name, content in cases.items():
        source = write_home(tmp_path / "evil.sh3d", FLAT, {"0": CUBE, name: content})
        with pytest.raises(AssetError):
            import_scene(source, tmp_path / "evil.yaml", packs)
    with zipfile.ZipFile(tmp_path / "old.sh3d", "w") as archive:
        archive.writestr("Home", b"serialised")
    with pytest.raises(AssetError, match="opened and saved"):
        import_scene(tmp_path / "old.sh3d", tmp_path / "old.yaml", packs)
    (tmp_path / "no.sh3d").write_bytes(b"not a zip")
    with pytest.raises(AssetError, match="no zip archive"):
        import_scene(tmp_path / "no.sh3d", tmp_path / "no.yaml", packs)
    assert not packs.exists()
    assert not (tmp_path / "evil").exists()


def test_models_outside_of_the_archive_are_not_read(tmp_path: Path, packs: Path) -> None:
    """A piece whose model is a path out of the archive is left out, with a note."""
    (tmp_path / "secret.obj").write_bytes(CUBE)
    xml = FLAT.replace("model='0' x='150'", f"model='{tmp_path}/secret.obj' x='150'")
    report = import_scene(write_home(tmp_path / "f.sh3d", xml), tmp_path / "f.yaml", packs)
    assert "Chair" not in entries(tmp_path / "f.yaml")
    assert any("'Chair' was left out" in note for note in report.notes)


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    places=st.lists(
        st.tuples(st.integers(0, len(FLAT) - 1), st.binary(max_size=6)), min_size=1, max_size=6
    ),
    model=st.binary(max_size=200),
    own=st.booleans(),
)
def test_whatever_is_in_the_file_is_read_or_refused(
    tmp_path: Path, places: list[tuple[int, bytes]], model: bytes, own: bool
) -> None:
    """Plans with bytes exchanged, models of noise: a scene, or one of our own errors."""
    data = bytearray(FLAT.encode())
    for at, given_bytes in places:
        data[at : at + len(given_bytes)] = given_bytes
    source = write_home(tmp_path / "fuzz.sh3d", bytes(data), {"0": CUBE if own else b"v " + model})
    with contextlib.suppress(SailenvError):
        assert len(import_sweet_home(source, Names("fuzz"), {}).objects) <= 40


def test_nothing_is_overwritten_unless_asked(tmp_path: Path, packs: Path) -> None:
    """Neither the scene nor its pack; with --overwrite both are replaced."""
    source, scene = write_home(tmp_path / "flat.sh3d"), tmp_path / "flat.yaml"
    assert main(["scene", "import", str(source), "-o", str(scene), "--pack", str(packs)]) == 0
    first = scene.read_bytes(), sorted(file.name for file in packs.iterdir())
    with pytest.raises(InvalidRequest, match="scene file"):
        import_scene(source, scene, packs)
    scene.unlink()
    with pytest.raises(InvalidRequest, match="pack folder"):
        import_scene(source, scene, packs)
    import_scene(source, scene, packs, overwrite=True)
    assert (scene.read_bytes(), sorted(file.name for file in packs.iterdir())) == first
    assert main(["scene", "check", str(scene)]) == 0


def test_other_kinds_of_files_are_refused(tmp_path: Path, packs: Path) -> None:
    """With the kinds that there are."""
    (tmp_path / "a.blend").write_bytes(b"")
    with pytest.raises(InvalidRequest, match=r"\.sh3d"):
        import_scene(tmp_path / "a.blend", tmp_path / "a.yaml", packs)
    with pytest.raises(AssetError, match="no such file"):
        import_scene(tmp_path / "b.sh3d", tmp_path / "a.yaml", packs)
    with pytest.raises(InvalidRequest, match="scene file"):
        import_scene(tmp_path / "b.sh3d", tmp_path / "a.txt", packs)
