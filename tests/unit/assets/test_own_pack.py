"""The user's own pack takes from several at once, loses nothing, and says what is damaged."""

from __future__ import annotations

import dataclasses
import inspect
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.assets.folders import own_pack_folder
from sailenv_ros.assets.own_pack import add_to_own_pack
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import Asset, ConvexShape

IMPORTS = """
from __future__ import annotations
import dataclasses
import numpy as np
from sailenv_ros.assets.own_pack import add_to_own_pack
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.types.model import Asset, ConvexShape
"""

ADD = """
import sys
sys.stdin.read()
for name in sys.argv[1:]:
    add_to_own_pack(named(name))
"""


def named(name: str, solid: str = "cube") -> Asset:
    """Return a solid under another name, with something to collide."""
    asset = Primitives().load(solid)
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (0.0, 2.0)])
    return dataclasses.replace(
        asset,
        name=name,
        display_name=name.title(),
        category="box",
        collision=(ConvexShape(points=corners),),
    )


@pytest.fixture(autouse=True)
def own_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path / "cache"))


def test_of_parallel_additions_none_is_lost() -> None:
    """Processes that add at the same time wait for each other."""
    wanted = [[f"thing_{who}_{number}" for number in range(3)] for who in range(4)]
    adding = [
        subprocess.Popen(
            [sys.executable, "-c", IMPORTS + inspect.getsource(named) + ADD, *names],
            stdin=subprocess.PIPE,
        )
        for names in wanted
    ]
    for process in adding:
        assert process.stdin is not None
        process.stdin.close()  # all begin now
    assert [process.wait(60) for process in adding] == [0, 0, 0, 0]
    pack = AssetPack(own_pack_folder())
    assert set(pack.entries) == {name for names in wanted for name in names}
    assert not pack.problems()
    assert pack.load("thing_0_0").name == "thing_0_0"


def test_what_is_replaced_is_whole_at_every_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    """A failure between the model and `pack.yaml` leaves the old asset as it was."""
    add_to_own_pack(named("thing", "cube"))
    before = AssetPack(own_pack_folder()).load("thing")

    def fail(*_: object) -> None:
        raise RuntimeError

    with monkeypatch.context() as patched:
        patched.setattr("sailenv_ros.assets.own_pack.write_content", fail)
        with pytest.raises(RuntimeError):
            add_to_own_pack(named("thing", "sphere"))
    pack = AssetPack(own_pack_folder())
    assert not pack.problems()
    assert pack.load("thing").model.triangle_count == before.model.triangle_count
    add_to_own_pack(named("thing", "sphere"))
    assert AssetPack(own_pack_folder()).load("thing").model.triangle_count > 100


def test_what_the_user_wrote_into_the_pack_stays() -> None:
    """Title and categories are the user's."""
    add_to_own_pack(named("thing"))
    file = own_pack_folder() / "pack.yaml"
    file.write_text(
        file.read_text() + "categories: [{id: 210, name: gizmo, colour: '#010203'}]\n",
    )
    add_to_own_pack(named("other"))
    assert [entry.name for entry in AssetPack(own_pack_folder()).content.categories] == ["gizmo"]


@pytest.mark.parametrize("damage", ["gone", "empty", "flipped"])
def test_a_damaged_model_is_found_and_never_drawn(damage: str) -> None:
    """One sentence names the file and what to do."""
    add_to_own_pack(named("thing"))
    pack = AssetPack(own_pack_folder())
    file = own_pack_folder() / pack.entries["thing"].file
    data = bytearray(file.read_bytes())
    data[-9] ^= 4  # in a coordinate of the last vertex
    if damage == "gone":
        file.unlink()
    else:
        file.write_bytes(b"" if damage == "empty" else data)
    sentence = "is missing" if damage == "gone" else "its checksum is wrong"
    with pytest.raises(AssetError, match=f"{sentence}.*; add it anew with: sailenv assets add"):
        pack.load("thing")
    assert list(pack.problems()) == [file.name]


def test_files_of_hand_made_packs_need_no_checksum() -> None:
    """They are read as they are."""
    add_to_own_pack(named("thing"))
    file = own_pack_folder() / "pack.yaml"
    lines = [line for line in file.read_text().splitlines() if "sha256" not in line]
    file.write_text("\n".join(lines))
    pack = AssetPack(own_pack_folder())
    assert pack.load("thing").name == "thing"
    assert not pack.problems()
