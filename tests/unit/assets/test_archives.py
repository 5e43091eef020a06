"""Archives that strangers made cannot write outside, fill the disk or hide links."""

from __future__ import annotations

import contextlib
import io
import stat
import warnings
import zipfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.assets import archives
from sailenv_ros.assets.archives import unpack_zip
from sailenv_ros.errors import AssetError


def made(path: Path, members: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


def test_an_honest_archive_is_unpacked(tmp_path: Path, folder: Path) -> None:
    """Files come out with their folders and their bytes."""
    archive = made(tmp_path / "a.zip", {"model/a.obj": b"v 0 0 0\n", "model/maps/a.png": b"\x89"})
    files = unpack_zip(archive, folder)
    assert {str(f.relative_to(folder)) for f in files} == {"model/a.obj", "model/maps/a.png"}
    assert (folder / "model/a.obj").read_bytes() == b"v 0 0 0\n"


@pytest.mark.parametrize(
    "name",
    [
        "../evil",
        "a/../../evil",
        "/etc/evil",
        "..\\evil",
        "C:\\evil",
        "a/./../..//evil",
        "x\nx",
        "..",
    ],
)
def test_paths_that_lead_out_are_refused(tmp_path: Path, folder: Path, name: str) -> None:
    """Nothing is written for an archive with one bad path, not even its good files."""
    archive = made(tmp_path / "a.zip", {"good": b"1", name: b"2"})
    with pytest.raises(AssetError, match=r"leads out|malformed"):
        unpack_zip(archive, folder)
    assert list(folder.iterdir()) == []
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.zip", "out"]


def test_links_are_refused(tmp_path: Path, folder: Path) -> None:
    """A symbolic link could point anywhere."""
    info = zipfile.ZipInfo("link")
    info.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr(info, "/etc/passwd")
    with pytest.raises(AssetError, match="a link"):
        unpack_zip(tmp_path / "a.zip", folder)
    assert list(folder.iterdir()) == []


def test_bombs_are_refused(tmp_path: Path, folder: Path) -> None:
    """A small archive that grows a thousandfold is not unpacked."""
    archive = made(tmp_path / "a.zip", {"a.obj": bytes(32 * 2**20)})
    assert archive.stat().st_size < 2**20
    with pytest.raises(AssetError, match="far more than it should"):
        unpack_zip(archive, folder)
    assert list(folder.iterdir()) == []


def test_a_lie_about_the_size_is_found_out(
    tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What comes out is counted, whatever the archive says of itself."""
    monkeypatch.setattr(archives, "MAX_ARCHIVE_BYTES", 4 * 2**20)
    data = bytes(range(256)) * 2**15
    archive = made(tmp_path / "a.zip", {"a.obj": data})
    raw = bytearray(archive.read_bytes())
    place = raw.rindex(b"PK\x01\x02")
    raw[place + 24 : place + 28] = (2**20).to_bytes(4, "little")
    archive.write_bytes(raw)
    with pytest.raises(AssetError):
        unpack_zip(archive, folder)
    assert sum(f.stat().st_size for f in folder.rglob("*") if f.is_file()) <= 4 * 2**20


def test_names_that_stand_twice_are_refused(tmp_path: Path, folder: Path) -> None:
    """The second of two files of one name would replace the first."""
    with warnings.catch_warnings(), zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        warnings.simplefilter("ignore")
        archive.writestr("a", "1")
        archive.writestr("a", "2")
    with pytest.raises(AssetError, match="twice"):
        unpack_zip(tmp_path / "a.zip", folder)


def test_too_many_files_are_refused(
    tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An archive of very many files is refused before the first is written."""
    monkeypatch.setattr(archives, "MAX_MEMBERS", 3)
    archive = made(tmp_path / "a.zip", {str(n): b"" for n in range(4)})
    with pytest.raises(AssetError, match="4 files"):
        unpack_zip(archive, folder)


@given(cut=st.integers(0, 400), noise=st.binary(max_size=40))
def test_damaged_archives_are_an_error_of_ours(
    tmp_path_factory: pytest.TempPathFactory, cut: int, noise: bytes
) -> None:
    """Wherever an archive is cut or overwritten, the answer is an AssetError or the files."""
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.obj", b"v 0 0 0\n" * 50)
        archive.writestr("a.mtl", b"newmtl a\n")
    data = bytearray(whole.getvalue())
    data[cut : cut + len(noise)] = noise
    path = tmp_path_factory.mktemp("damaged")
    (path / "a.zip").write_bytes(data[: max(cut, 40)] if cut % 2 else data)
    (path / "out").mkdir()
    with contextlib.suppress(AssetError):
        unpack_zip(path / "a.zip", path / "out")
    assert {p.name for p in path.iterdir()} == {"a.zip", "out"}


def test_a_member_without_a_name_is_refused(tmp_path: Path) -> None:
    """The zip reader itself stumbles over it."""
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("ab", b"")
    data = (tmp_path / "a.zip").read_bytes()
    at = data.index(b"PK\1\2")
    central = bytearray(data[at:])
    central[28:30] = b"\0\0"  # the length of the name
    (tmp_path / "a.zip").write_bytes(data[:at] + bytes(central))
    (tmp_path / "out").mkdir()
    with pytest.raises(AssetError):
        unpack_zip(tmp_path / "a.zip", tmp_path / "out")
