"""What lies damaged in the cache is told in a sentence and made anew."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from sailenv_content.standard import pack_build as build
from sailenv_content.standard.fetch import fetched, kept_folder
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.checksums import damaged_by_manifest, write_manifest
from sailenv_ros.assets.folders import standard_pack_folder
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.assets.recipe import Recipe, standard_recipe
from sailenv_ros.assets.skies import load_sky, sky_files
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.cli.main import main
from sailenv_ros.errors import AssetError, UnknownName

FURNITURE, SKIES = (fetched(name) for name in ("sweethome3d-furniture", "blender-data"))
NAMES = ("fork_01", "spoon_01")


def small_recipe() -> Recipe:
    """Return the recipe of a pack that is made in seconds."""
    whole = standard_recipe()
    return whole.model_copy(update={"assets": {name: whole.assets[name] for name in NAMES}})


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache with a small pack."""
    cache = tmp_path_factory.mktemp("built")
    with pytest.MonkeyPatch.context() as patched:
        use(cache, patched)
        build.build_standard_pack(jobs=1)
    return cache


def use(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the small pack built there."""
    monkeypatch.setenv("SAILENV_CACHE", str(cache))
    monkeypatch.setenv("XDG_DATA_HOME", str(cache / "data"))
    monkeypatch.setattr(build, "standard_recipe", small_recipe)
    few = cache.with_name(f"{cache.name}_skies")
    if not few.exists():
        few.mkdir()
        shutil.copy(SKIES / "night.exr", few)
    sources = {"sweethome3d-furniture": FURNITURE, "blender-data": few}
    monkeypatch.setattr(build, "fetched", lambda name, **_: sources[name])


@pytest.fixture
def pack(built: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A small pack in a cache of the test's own."""
    shutil.copytree(built, tmp_path / "cache")
    use(tmp_path / "cache", monkeypatch)
    return standard_pack_folder()


def flip(file: Path) -> None:
    """Change one bit in the middle."""
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 1
    file.write_bytes(data)


def test_damaged_objects_are_found_and_made_anew(
    pack: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Only they are made, byte for byte as they were; everything else is kept."""
    file, sky = pack / "fork_01.glb", next((pack / "skies").iterdir())
    whole = {path: path.read_bytes() for path in (file, sky)}
    assert main(["assets", "verify"]) == 0
    assert "all files are whole" in capsys.readouterr().out
    flip(file)
    flip(sky)
    assert not build.is_current()
    with pytest.raises(AssetError, match=r"checksum is wrong.*; make it anew with: sailenv assets"):
        AssetPack(pack).load("fork_01")
    with pytest.raises(AssetError, match=r"checksum is wrong.*; make it anew with: sailenv assets"):
        load_sky(sky.stem, sky_files([pack]))
    assert main(["assets", "verify"]) == 1
    told = capsys.readouterr().out
    assert f"{file}: is damaged (its checksum is wrong); sailenv assets build" in told
    said: list[str] = []
    made: list[str] = []
    build.build_standard_pack(progress=lambda name, *_: made.append(name), say=said.append, jobs=1)
    assert "fork_01.glb is damaged (its checksum is wrong) and is made anew" in said
    assert made == ["fork_01"]
    assert {path: path.read_bytes() for path in (file, sky)} == whole
    assert build.is_current()


def test_some_objects_can_be_built_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The others are known and missing until the rest is built; what was built first stays."""
    use(tmp_path / "cache", monkeypatch)
    with pytest.raises(UnknownName, match="no_fork"):
        build.build_standard_pack(jobs=1, names=["no_fork"])
    build.build_standard_pack(jobs=1, names=["fork_01"])
    folder = standard_pack_folder()
    assert AssetPack(folder).content.missing == ("spoon_01",)
    assert build.is_current(names=["fork_01"])
    assert not build.is_current()
    library = AssetLibrary(installed_sources())
    fork = library.get("fork_01")
    with pytest.raises(AssetError, match="has not been built on this machine yet"):
        library.get("spoon_01")
    made: list[str] = []
    build.build_standard_pack(progress=lambda name, *_: made.append(name), jobs=1)
    assert made == ["spoon_01"]
    assert build.is_current()
    library.renew(installed_sources())
    assert library.get("spoon_01").name == "spoon_01"
    assert library.get("fork_01") is fork


def test_an_empty_object_is_not_up_to_date(pack: Path) -> None:
    """The pack's own word for it is not enough."""
    (pack / "spoon_01.glb").write_bytes(b"")
    assert not build.is_current()
    assert list(build.damaged_files()) == ["spoon_01.glb"]
    (pack / "pack.yaml").write_bytes(b"")
    assert list(build.damaged_files()) == ["pack.yaml"]
    build.build_standard_pack(jobs=1)
    assert build.is_current()


def test_sources_that_were_downloaded_are_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a manifest as `sha256sum` writes it; one is damaged, one is gone."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    folder = kept_folder("blender-data")
    folder.mkdir(parents=True)
    for name in "abc":
        np.save(folder / name, np.arange(9))
    assert not damaged_by_manifest(folder)
    write_manifest(folder)
    subprocess.run(["sha256sum", "--check", "--quiet", "SHA256SUMS"], cwd=folder, check=True)
    assert not damaged_by_manifest(folder)
    flip(folder / "a.npy")
    (folder / "b.npy").unlink()
    assert damaged_by_manifest(folder) == {
        "a.npy": "is damaged (its checksum is wrong)",
        "b.npy": "is missing",
    }
    assert main(["assets", "verify"]) == 1
