"""Pictures of the catalogue: drawn beside the simulation, kept, and told when they cannot be."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image

from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.errors import InvalidState, RenderError, SimulationClosed, UnknownName
from sailenv_ros.simulation.models import thumbnails as module
from sailenv_ros.simulation.models.thumbnails import Thumbnails
from sailenv_ros.types.model import Asset


class Catalogue:
    """The solids, and what tests upload."""

    def __init__(self) -> None:
        self.solids = Primitives()
        self.uploads: dict[str, Asset] = {}
        self.fingerprint = "first"

    def canonical_asset(self, name: str) -> str:
        names = (*self.solids.display_names, *self.uploads)
        if name not in names:
            raise UnknownName("asset", name, names)
        return name

    def asset_fingerprint(self, name: str) -> str:
        return "" if name in self.uploads else self.fingerprint

    def peek_asset(self, name: str) -> Asset:
        return self.uploads.get(name) or self.solids.load(name)


class Painter:
    """Stands in for the process: pictures with a number, so that each can be told apart."""

    drawn: list[object]

    def __init__(self, backend: str, device: int | None) -> None:
        self.is_alive = True

    def thumbnail(self, asset: object) -> bytes:
        if asset == "cone":
            raise RenderError("it has a point")
        Painter.drawn.append(asset)
        data = io.BytesIO()
        Image.new("RGB", (2, 2), (len(Painter.drawn), 0, 0)).save(data, "PNG")
        return data.getvalue()

    def kill(self) -> None:
        self.is_alive = False

    def close(self) -> None:
        self.is_alive = False


@pytest.fixture
def catalogue() -> Catalogue:
    return Catalogue()


@pytest.fixture
def thumbnails(
    catalogue: Catalogue, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Thumbnails]:
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    monkeypatch.setattr(module, "PreviewProcess", Painter)
    Painter.drawn = []
    made = Thumbnails(lambda: catalogue, "gl", None)
    yield made
    made.close()


def picture(thumbnails: Thumbnails, name: str) -> bytes:
    return thumbnails.begin(name).result(20.0)


def test_a_picture_is_drawn_once_and_kept_for_others(
    thumbnails: Thumbnails, catalogue: Catalogue
) -> None:
    """A second simulator finds it in the cache; a pack that was made anew has others."""
    first = picture(thumbnails, "cube")
    assert picture(thumbnails, "cube") == first
    other = Thumbnails(lambda: catalogue, "gl", None)
    assert picture(other, "cube") == first
    other.close()
    assert Painter.drawn == ["cube"]
    catalogue.fingerprint = "second"
    assert picture(thumbnails, "cube") != first
    assert picture(thumbnails, "sphere") != picture(thumbnails, "cube")


@pytest.mark.parametrize("damage", ["empty", "cut", "flipped"])
def test_a_broken_file_of_the_cache_is_replaced(
    thumbnails: Thumbnails, tmp_path: Path, damage: str, caplog: pytest.LogCaptureFixture
) -> None:
    """What is no whole picture is drawn again, and the log says so."""
    first = picture(thumbnails, "cube")
    (kept,) = (tmp_path / "thumbnails").iterdir()
    flipped = bytearray(first)
    flipped[len(first) // 2] ^= 1
    kept.write_bytes({"empty": b"", "cut": first[:-5], "flipped": bytes(flipped)}[damage])
    assert picture(thumbnails, "cube") == kept.read_bytes()
    assert module.is_whole_png(kept.read_bytes())
    assert "made anew" in caplog.text
    assert len(Painter.drawn) == 2


def test_uploaded_models_are_pictured_but_not_kept(
    thumbnails: Thumbnails, catalogue: Catalogue, tmp_path: Path
) -> None:
    """They are known in this simulator alone: the model itself is handed over, once."""
    catalogue.uploads["mine"] = model = Primitives().load("sphere")
    assert picture(thumbnails, "mine") == picture(thumbnails, "mine")
    assert Painter.drawn == [model]
    assert not (tmp_path / "thumbnails").exists()


def test_a_cache_that_cannot_be_written_keeps_nobody_from_pictures(
    thumbnails: Thumbnails, tmp_path: Path
) -> None:
    """It is told in the log, and drawn again the next time."""
    (tmp_path / "thumbnails").write_text("in the way", encoding="utf-8")
    assert picture(thumbnails, "cube") != picture(thumbnails, "cube")


def test_who_waits_is_told_what_went_wrong(
    thumbnails: Thumbnails, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An unknown name at once; a failure of drawing, and the next one is drawn all the same."""
    with pytest.raises(UnknownName, match="did you mean 'cube'"):
        thumbnails.begin("cub")
    with pytest.raises(RenderError, match="a point"):
        picture(thumbnails, "cone")
    assert picture(thumbnails, "cube")
    monkeypatch.setattr(module, "MAX_WAITING", 0)
    with pytest.raises(InvalidState, match="0 thumbnails are waiting"):
        thumbnails.begin("cube")
    thumbnails.close()
    with pytest.raises(SimulationClosed):
        thumbnails.begin("cube")
