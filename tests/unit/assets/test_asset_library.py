"""Assets are found by catalogue or display name and loaded once."""

from __future__ import annotations

import threading
from collections.abc import Mapping

import pytest

from sailenv_ros.assets import AssetLibrary, load_categories
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.errors import AssetError, NameTaken, UnknownName
from sailenv_ros.types.model import Asset, Model


class Chairs:
    """A source that counts what it loads."""

    def __init__(self, names: Mapping[str, str]) -> None:
        self.display_names = names
        self.loaded: list[str] = []

    def load(self, name: str) -> Asset:
        if name == "broken":
            raise AssetError(name, "has no legs")
        self.loaded.append(name)
        model = Model(name=name, parts=())
        return Asset(
            name=name,
            display_name=self.display_names[name],
            category="chair",
            model=model,
            collision=(),
        )


@pytest.fixture
def chairs() -> Chairs:
    return Chairs({"chair_01": "Chair 01", "chair_02": "Chair 02", "broken": "Broken"})


def test_without_sources_there_are_the_built_in_solids() -> None:
    assert AssetLibrary().names == ("cube", "sphere", "cylinder", "cone", "plane")


def test_catalogue_and_display_name_give_the_same_object(chairs: Chairs) -> None:
    library = AssetLibrary([Primitives(), chairs])
    assert library.get("chair_01") is library.get("Chair 01") is library.get("chair_01")
    assert library.get("Cube") is library.get("cube")
    assert chairs.loaded == ["chair_01"]


def test_nothing_is_loaded_before_it_is_asked_for(chairs: Chairs) -> None:
    library = AssetLibrary([chairs])
    assert library.names == ("chair_01", "chair_02", "broken")
    assert library.canonical("Chair 02") == "chair_02"
    assert "Chair 02" in library.all_names
    assert chairs.loaded == []


def test_an_unknown_name_is_answered_with_the_nearest(chairs: Chairs) -> None:
    library = AssetLibrary([chairs])
    with pytest.raises(UnknownName, match=r"did you mean 'Chair 01'\?\), got 'Chair 1'"):
        library.get("Chair 1")


def test_two_sources_may_not_share_a_name(chairs: Chairs) -> None:
    with pytest.raises(NameTaken, match="chair_01"):
        AssetLibrary([chairs, Chairs({"chair_01": "Another chair"})])
    with pytest.raises(NameTaken, match="Chair 02"):
        AssetLibrary([chairs, Chairs({"other": "Chair 02"})])


def test_an_asset_that_cannot_be_used_says_why_each_time(chairs: Chairs) -> None:
    library = AssetLibrary([chairs])
    for _ in range(2):
        with pytest.raises(AssetError, match="has no legs"):
            library.get("broken")


def test_threads_that_ask_at_once_get_the_same_object(chairs: Chairs) -> None:
    library = AssetLibrary([chairs])
    barrier = threading.Barrier(8)
    got: list[Asset] = []

    def ask() -> None:
        barrier.wait(timeout=10)
        got.append(library.get("chair_01"))

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=10)
    assert len(got) == 8
    assert len({id(asset) for asset in got}) == 1
    assert chairs.loaded == ["chair_01"]


def test_every_built_in_asset_has_a_category_of_the_table() -> None:
    library, table = AssetLibrary(), load_categories()
    for name in library.names:
        asset = library.get(name)
        assert asset.name == name
        assert table.named(asset.category).id > 0
