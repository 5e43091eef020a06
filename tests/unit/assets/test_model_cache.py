"""Models and surfaces from the cache equal those that are made, byte for byte."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest

from sailenv_content.families.making import make_piece
from sailenv_content.families.names import parsed
from sailenv_content.families.registry import CODE, family_named, family_names, family_styles
from sailenv_content.families.source import FamilySource
from sailenv_content.standard.pack_build import build_standard_pack
from sailenv_ros.assets import model_cache
from sailenv_ros.assets.glb import read_glb
from sailenv_ros.assets.kept_assets import KeptAssets
from sailenv_ros.assets.model_cache import read_once
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.assets.surfaces import surface_catalogue
from sailenv_ros.errors import AssetError
from sailenv_ros.system.array_cache import array_folder
from sailenv_ros.types.model import Asset
from tests.support.programs import run


@pytest.fixture(scope="module")
def pack() -> AssetPack:
    return AssetPack(build_standard_pack())


@pytest.fixture(autouse=True)
def own_cache(pack: AssetPack, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))


def same(one: object, other: object) -> bool:
    """Compare what models are made of, arrays by type, shape and bytes."""
    if isinstance(one, np.ndarray):
        assert isinstance(other, np.ndarray)
        alike = (one.dtype, one.shape) == (other.dtype, other.shape)
        return alike and one.tobytes() == other.tobytes()
    if isinstance(one, tuple):
        assert isinstance(other, tuple)
        return len(one) == len(other) and all(map(same, one, other))
    if is_dataclass(one):
        return type(one) is type(other) and all(
            same(getattr(one, field.name), getattr(other, field.name)) for field in fields(one)
        )
    return one == other


# Cut-outs, glass, glow, textures of normals, parts of their own, no collision pieces, many meshes.
@pytest.mark.parametrize(
    "name", ["plant_03", "lamp_02", "bookcase_02", "armchair_01", "fork_01", "bathtub_02"]
)
def test_a_model_from_the_cache_is_that_of_its_file(pack: AssetPack, name: str) -> None:
    entry = pack.entries[name]
    path = pack.folder / entry.file
    expected = read_glb(path)
    for _ in range(2):
        assert same(expected, read_once(path, entry.sha256))


def test_materials_that_were_one_are_one(pack: AssetPack) -> None:
    """Caches of renderers tell materials and textures apart by identity."""
    entry = pack.entries["bookcase_02"]
    path = pack.folder / entry.file
    made = read_glb(path)[0]
    for _ in range(2):
        parts = read_once(path, entry.sha256)[0]
        ids = [[id(part.material) for part in model] for model in (made, parts)]
        groups = [[model.index(number) for number in model] for model in ids]
        assert groups[0] == groups[1]


def test_equal_pictures_are_one_array(pack: AssetPack) -> None:
    """A file decodes the one print of a hundred books a hundred times: 1 MB each."""
    entry = pack.entries["bookcase_02"]
    parts, _ = read_once(pack.folder / entry.file, entry.sha256)
    textures = [part.material.base_colour_texture for part in parts]
    shown = [texture for texture in textures if texture is not None]
    assert len(shown) > 90
    assert len({id(one) for one in shown}) == len({one.tobytes() for one in shown})
    prints = [part.material for part in parts if part.material.name == "book print"]
    assert len(prints) > 90
    assert len({id(one.base_colour_texture) for one in prints}) == 1


def test_a_file_is_read_once(pack: AssetPack, monkeypatch: pytest.MonkeyPatch) -> None:
    """Unless nobody knows its checksum; a broken one is refused each time."""
    entry = pack.entries["fork_01"]
    path = pack.folder / entry.file
    read_once(path, entry.sha256)
    count = len(list(array_folder().iterdir()))

    def refuse(path: Path) -> None:
        raise AssetError(path.name, "it was read again")

    monkeypatch.setattr(model_cache, "read_glb", refuse)
    read_once(path, entry.sha256)
    for checksum in ("", "0" * 64):
        with pytest.raises(AssetError):
            read_once(path, checksum)
    assert len(list(array_folder().iterdir())) == count


@pytest.mark.parametrize("name", ["oak_planks", "metro_tiles"])
def test_a_surface_from_the_cache_is_the_one_that_was_made(name: str) -> None:
    arguments = name, (0.3, 0.2, 0.1), 7
    made, again = (surface_catalogue._made.__wrapped__(*arguments) for _ in range(2))
    assert same(made.material, again.material)
    assert (made.tile_m, made.turn_deg) == (again.tile_m, again.turn_deg)
    assert not again.material.base_colour_texture.flags.writeable


# Joints, glass, glow, patterns with and without normals, prints, hulls, leaves.
PIECES = (
    *("wardrobe~classic:4", "kitchen_unit~corner:1", "chest~dresser:2", "picture~row:3"),
    *("table_lamp~ceramic:1", "plant~tree:2", "sofa~rolled:5", "bath~claw_foot:1"),
)


def fresh(name: str, monkeypatch: pytest.MonkeyPatch) -> Asset:
    """Load a piece as a process does that has none."""
    monkeypatch.setattr("sailenv_content.families.source._made", KeptAssets())
    return FamilySource().load(name)


@pytest.mark.parametrize("name", PIECES)
def test_a_piece_from_the_cache_is_the_one_that_is_made(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = parsed(name)
    assert wanted is not None
    made = make_piece(family_named(wanted.family), wanted).asset
    for _ in range(2):
        kept = fresh(name, monkeypatch)
        assert same(made, kept)
        ways = {"mesh": ids(made, "mesh"), "material": ids(made, "material")}
        for attribute, before in ways.items():
            # What was one object is one; materials of equal values may have become one.
            assert len(set(zip(before, ids(kept, attribute), strict=True))) == len(set(before))
        assert len(set(ids(kept, "mesh"))) == len(set(ways["mesh"]))


def ids(asset: Asset, attribute: str) -> list[int]:
    """Return the identities of the meshes, or materials, of a piece and of its bodies."""
    bodies = [asset, *filter(None, [asset.still]), *(one.asset for one in asset.moving)]
    return [id(getattr(part, attribute)) for body in bodies for part in body.model.parts]


def test_the_styles_of_a_family_are_kept() -> None:
    for name in family_names():
        family_styles.cache_clear()
        assert family_styles(name) == tuple(family_named(name).styles)


def test_the_code_that_makes_a_piece_is_told_in_its_key() -> None:
    """Whoever changes it gets other pieces: all modules that families import are in its folders."""
    code = "import sys\nfrom sailenv_content.families.registry import *\n"
    code += "for name in family_names(): family_named(name)\n"
    code += "import sailenv_content.families.making\n"
    code += "print(*(name for name in sys.modules if name.startswith('sailenv_')))"
    packages = {name.rpartition(".")[0] for name in run(code).split()}
    told = {folder.replace("../", "").replace("/", ".") for folder in CODE}
    of_content = {package for package in packages if package.startswith("sailenv_content.")}
    assert of_content <= told
    # What reads scenes, files and lenses has no part in it.
    others = {package for package in packages - of_content if package.count(".") == 1}
    others = {package.removeprefix("sailenv_ros.") for package in others} - told
    assert others == {"native", "scene", "system"}


def test_a_kept_piece_needs_neither_scipy_nor_its_family() -> None:
    """To import them takes longer than all else that a small scene needs."""
    code = "import sys\nfrom sailenv_content.families.source import FamilySource\n"
    code += "FamilySource().load('chest~dresser:1')\n"
    code += "print(*(name in sys.modules for name in ('scipy', 'sailenv_content.families.kinds')))"
    assert [run(code) for _ in range(2)] == ["True True", "False False"]
