"""The standard pack holds what a furnished world needs, sized and finished as it should be."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from sailenv_content.procedural import PROCEDURAL
from sailenv_content.procedural.clutter import CLUTTER
from sailenv_content.standard.catalogues import Catalogues
from sailenv_content.standard.fetch import fetched
from sailenv_content.standard.pack_build import build_standard_pack, is_current, licence_files
from sailenv_ros.assets import AssetLibrary, load_categories
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.assets.recipe import read_recipe, standard_recipe
from sailenv_ros.assets.skies import SKIES
from sailenv_ros.assets.sources import UnbuiltPack, installed_sources
from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import Asset, ConvexShape

NAMES = tuple(standard_recipe().assets)
THE_FOURTEEN = {
    "bed",
    "book",
    "chair",
    "couch",
    "dining table",
    "fork",
    "laptop",
    "airplane",
    "potted plant",
    "remote",
    "spoon",
    "tennis racket",
    "toilet",
    "tv",
}
METALS = ("fork_01", "knife_01", "spoon_01", "towel_01", "waste_bin_01", "sink_01")


@pytest.fixture(scope="module")
def pack() -> AssetPack:
    return AssetPack(build_standard_pack())


@pytest.fixture(scope="module")
def assets(pack: AssetPack) -> dict[str, Asset]:
    return {name: pack.load(name) for name in NAMES}


def test_there_are_objects_enough() -> None:
    """At least 70 objects in 40 categories, among them the fourteen of the paper's experiment."""
    counted = Counter(entry.category for entry in standard_recipe().assets.values())
    assert counted.total() >= 70
    assert len(counted) >= 40
    assert set(counted) >= THE_FOURTEEN
    assert set(counted) <= {category.name for category in load_categories().values()}


def test_names_are_the_originals_where_those_are_known() -> None:
    """Scripts written for SAILenv find its names."""
    recipe = standard_recipe()
    names = {recipe.display_name(name) for name in recipe.assets}
    assert names >= {"Chair 01", "Pillow 01", "Dish 01", "Tennis Racket 01"}
    assert set(AssetLibrary().all_names) >= {"Cylinder", "Cube"}
    assert len(names) == len(recipe.assets)


def test_each_object_is_finished(pack: AssetPack, assets: dict[str, Asset]) -> None:
    """It stands on its base, has few triangles, unit normals, a mass and something to collide."""
    for name, asset in assets.items():
        entry = pack.entries[name]
        low, high = asset.model.bounds()
        np.testing.assert_allclose(high - low, entry.size, atol=2e-4, err_msg=name)
        assert low[2] == pytest.approx(0.0, abs=2e-3), name
        assert 0 < asset.model.triangle_count < 20_000, name
        assert asset.mass_kg > 0.0, name
        assert all((entry.licence, entry.author, entry.source)), name
        for part in asset.model.parts:
            lengths = np.linalg.norm(part.mesh.normals, axis=1)
            np.testing.assert_allclose(lengths, 1.0, atol=1e-3, err_msg=name)
            assert part.material.alpha != "blend", name
        for shape in asset.collision:
            if isinstance(shape, ConvexShape):
                assert (shape.points >= low - 0.01).all(), name
                assert (shape.points <= high + 0.01).all(), name


def test_each_object_has_its_catalogues_size(assets: dict[str, Asset]) -> None:
    """The catalogue's width, depth and height are the model's, within a millimetre and 2 %."""
    catalogues = Catalogues(fetched("sweethome3d-furniture"))
    for name, asset in assets.items():
        source = standard_recipe().assets[name].source
        library, _, what = source.partition("/")
        if library == "made":
            assert what in PROCEDURAL, name
            continue
        size = np.ptp(asset.model.bounds(), axis=0)
        expected = catalogues.entry(source).size_m
        np.testing.assert_allclose(size, expected, rtol=0.02, atol=1e-3, err_msg=name)


def test_metal_is_metal_and_screens_are_black_glass(assets: dict[str, Asset]) -> None:
    """Materials are what their names say."""
    for name in METALS:
        assert max(p.material.metallic for p in assets[name].model.parts) == pytest.approx(1.0)
    for name in ("tv_01", "tv_02", "laptop_01"):
        screens = [
            p.material for p in assets[name].model.parts if "screen" in p.material.name.lower()
        ]
        assert screens
        for screen in screens:
            assert max(screen.base_colour[:3]) < 0.05
            assert screen.roughness < 0.2
    for name in ("chair_02", "pillow_01", "towel_02", "bed_02"):
        assert max(p.material.roughness for p in assets[name].model.parts) > 0.9


def test_leaves_are_seen_from_both_sides(assets: dict[str, Asset]) -> None:
    """Leaves are sheets."""
    for name in ("plant_01", "plant_03", "plant_05"):
        leaves = [p for p in assets[name].model.parts if p.material.name.lower().startswith("lea")]
        assert leaves
        assert all(part.material.double_sided for part in leaves)


@pytest.mark.parametrize(
    ("name", "labels"),
    [
        ("bed_01", {"pillow": 2}),
        ("bed_02", {"pillow": 2}),
        ("couch_01", {"pillow": 2}),
        ("bowl_02", {"apple": 2, "orange": 2, "banana": 2, "pear": 3}),
        ("book_02", {"book": 3}),
        ("bookcase_01", {"book": 150}),
        ("cabinet_03", {"sink": 1, "tap": 1}),
        ("sink_01", {"tap": 1}),
        ("pencil_cup_01", {"pencil": 1, "pen": 2}),
        ("toothbrush_cup_01", {"toothbrush": 2}),
        ("cake_01", {"cake": 1, "fork": 1}),
        ("cup_03", {"spoon": 1}),
    ],
)
def test_what_annotators_would_label_apart_is_a_part(
    name: str, labels: dict[str, int], assets: dict[str, Asset]
) -> None:
    """Fruit is not a bowl, pillows are not a bed, books no bookcase."""
    asset = assets[name]
    assert Counter(part.category for part in asset.parts) == labels
    known = {category.name for category in load_categories().values()}
    assert set(labels) <= known
    whole = asset.model.triangle_count
    divided = sum(asset.part_model(part).triangle_count for part in asset.parts)
    assert 0 < divided < whole
    assert asset.body_model.triangle_count == whole - divided
    for part in asset.parts:
        low, high = asset.part_model(part).bounds()
        assert (low >= asset.model.bounds()[0] - 1e-6).all()
        assert (high <= asset.model.bounds()[1] + 1e-6).all()


def test_there_is_enough_that_lies_about(assets: dict[str, Asset]) -> None:
    """Small things for tables, shelves and desks, each of the size of the real one."""
    recipe = standard_recipe().assets
    small = [name for name in recipe if recipe[name].source.partition("/")[2] in CLUTTER]
    assert len(small) >= 50
    for name in small:
        longest = np.ptp(assets[name].model.bounds(), axis=0).max()
        assert 0.04 < longest < 0.45, name


def test_credits_and_skies_are_kept(pack: AssetPack) -> None:
    """The licence text of every library that was used lies in the pack, and the skies do."""
    texts = {path.parent.name for path in licence_files(pack.folder)}
    used = {entry.source.partition("/")[0] for entry in standard_recipe().assets.values()}
    assert texts >= (used - {"made"}) | {"blender-data"}
    assert len(list((pack.folder / SKIES).glob("*.npy"))) == 8


def test_building_again_changes_nothing(pack: AssetPack) -> None:
    """A pack that is up to date is left as it is."""
    before = {path: path.stat().st_mtime_ns for path in pack.folder.iterdir()}
    assert is_current()
    assert build_standard_pack() == pack.folder
    assert {path: path.stat().st_mtime_ns for path in pack.folder.iterdir()} == before


def test_without_the_pack_its_names_tell_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One sentence names the command; the solids are there all the same."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    library = AssetLibrary(installed_sources())
    assert library.get("Cube").name == "cube"
    with pytest.raises(AssetError, match="sailenv assets build"):
        library.get("Chair 01")
    assert set(UnbuiltPack().display_names) == set(NAMES)


def test_a_failed_build_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without its sources the error says what to install, and no half pack stays."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(
        "sailenv_content.standard.fetch.SOURCES",
        {"sweethome3d-furniture": "nowhere", "blender-data": "nowhere"},
    )
    with pytest.raises(AssetError, match=r"install Debian's or Ubuntu's package"):
        build_standard_pack()
    assert not (tmp_path / "packs").exists()


@pytest.mark.parametrize(
    "text",
    [
        "version: 2\ntitle: a\nassets: {}",
        "version: 1\ntitle: a\nassets: {a: {category: chair, source: x, mass: -1}}",
        "version: 1\ntitle: a\n"
        "assets: {a: {category: chair, source: x, mass: 1, materials: {a: b}}}",
        "- 1",
        "a: [",
    ],
)
def test_a_broken_recipe_is_refused(tmp_path: Path, text: str) -> None:
    """Unknown finishes, impossible masses and broken YAML are errors that name the file."""
    (tmp_path / "recipe.yaml").write_text(text)
    with pytest.raises(AssetError, match=r"recipe\.yaml"):
        read_recipe(tmp_path / "recipe.yaml")
