"""Baked light finds its scene; where there is none the log says what to do, once."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path

import pytest

from sailenv_ros.cli import scene_bake
from sailenv_ros.cli.main import main
from sailenv_ros.errors import InvalidState
from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.light_files import (
    is_baked,
    load_baked,
    remember,
    store_baked,
    store_draft,
)
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.simulation import Simulation, light_cache
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.light_choice import LightChoice
from sailenv_ros.types.scene_info import TimeMode
from sailenv_ros.types.snapshot import SceneContents
from tests.support.bake_scenes import COARSE

ROOM = """
version: 1
title: Cell
lights:
  - {name: lamp, type: point, position: [0, 0, 1.5]}
room: {size: [2, 2, 2]}
objects:
  - {name: ball, asset: sphere, position: [0, 0, 1]}
"""


def contents(library: SceneLibrary, scene: str | Path) -> SceneContents:
    """What is in a scene's world just after it was built."""
    world = library.build(scene)
    try:
        return world.snapshot().contents
    finally:
        world.close()


def quick_bake(library: SceneLibrary, scene: str | Path) -> BakedLight:
    """Bake coarsely what is then kept as if it were fine."""
    snapshot = library.snapshot(scene)
    settings = replace(COARSE, texel_m=0.3, rays=4, pass_rays=4)
    return replace(bake(snapshot, settings=settings), fingerprint=fingerprint(snapshot))


def test_a_room_gets_its_light_from_the_cache(cell: Path) -> None:
    """Also in the next epoch, from the same object: a reset loads nothing."""
    library = SceneLibrary()
    store_baked(quick_bake(library, cell))
    first, second = contents(library, cell).baked, contents(library, cell).baked
    assert first is not None
    assert second is not None
    assert first.layers[1].bounced is second.layers[1].bounced
    assert set(first.charts) == {
        drawn.instance.id for drawn in contents(library, cell).instances if drawn.instance.static
    }


def test_light_is_read_while_its_world_is_built(
    cell: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once, if the note of its file is right; a wrong note costs time alone."""
    read: list[str] = []

    def counted(name: str) -> BakedLight | None:
        read.append(name)
        return load_baked(name)

    monkeypatch.setattr(light_cache, "load_baked", counted)
    light = quick_bake(SceneLibrary(), cell)
    store_baked(light)
    read.clear()
    wrong = "0" * 32
    for note, wanted in (
        (wrong, {wrong, light.fingerprint}),
        (light.fingerprint, {light.fingerprint}),
    ):
        remember(SceneLibrary().stamp(cell), note)
        assert contents(SceneLibrary(), cell).baked is not None
        assert len(read) == len(wanted)
        assert set(read) == wanted
        read.clear()
    assert contents(SceneLibrary(baked_light=False), cell).baked is None
    assert not read
    remember(SceneLibrary().stamp(cell), wrong)
    library = SceneLibrary()
    for _ in range(3):
        assert contents(library, cell).baked is not None
    assert sorted(read) == sorted([wrong, light.fingerprint])


def test_a_draft_stands_in_until_the_light_is_there(cell: Path) -> None:
    """A simulation that runs shows the draft when told, then the light; a draft is no light."""
    library = SceneLibrary()
    world = library.build(cell)
    try:
        final = quick_bake(library, cell)
        draft = replace(final, layers=tuple(replace(layer) for layer in final.layers))
        store_draft(draft)
        library.load_light(world)
        shown = world.contents.baked
        assert shown is not None
        library.load_light(world)
        assert not is_baked(final.fingerprint)
        path = store_baked(final)
        assert not path.with_suffix(".draft").exists()
        library.load_light(world)
        now = world.contents.baked
        assert now is not None
        assert now.layers is not shown.layers
        library.load_light(world)
        assert world.contents.baked is now
    finally:
        world.close()


def test_what_must_not_depend_on_a_bake_takes_no_draft(cell: Path) -> None:
    """A data set's frames are the same, however far a bake in the same cache has come."""
    library = SceneLibrary(drafts=False)
    light = quick_bake(library, cell)
    store_draft(light)
    assert contents(library, cell).baked is None
    assert contents(SceneLibrary(), cell).baked is not None
    store_baked(light)
    assert contents(library, cell).baked is not None


def lit(scene: Path, light: LightChoice, mode: TimeMode = "lockstep") -> bool:
    """Whether a simulation that begins has baked light."""
    with Simulation(scene, mode=mode, backend="native", light=light) as simulation:
        return simulation.contents.baked is not None


def test_finished_light_is_required_or_left_out(cell: Path) -> None:
    """In lockstep no draft is shown; `baked` does not begin with one, `plain` has no light."""
    with pytest.raises(InvalidState, match="is not baked; bake it with: sailenv scene bake"):
        lit(cell, "baked")
    light = quick_bake(SceneLibrary(), cell)
    store_draft(light)
    assert lit(cell, "newest", "realtime")
    assert not lit(cell, "newest")
    assert not lit(cell, "plain")
    with pytest.raises(InvalidState, match="is not baked"):
        lit(cell, "baked")
    store_baked(light)
    assert lit(cell, "newest")
    assert lit(cell, "baked")
    assert not lit(cell, "plain")


def test_a_room_without_light_is_told_how_to_get_it(
    cell: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """One sentence with the command; a scene without a room is not spoken of."""
    caplog.set_level(logging.INFO, "sailenv_ros.simulation.light_cache")
    assert contents(SceneLibrary(), cell).baked is None
    assert [r.getMessage().endswith(f"sailenv scene bake {cell}") for r in caplog.records] == [True]
    caplog.clear()
    assert contents(SceneLibrary(), "optical").baked is None
    assert not caplog.records


def test_a_stamp_changes_with_the_file(cell: Path) -> None:
    """What was known of a scene is not believed of another one in its place."""
    before = SceneLibrary().stamp(cell)
    assert SceneLibrary().stamp(cell) == before
    cell.write_text(ROOM.replace("1.5", "1.4"))
    assert SceneLibrary().stamp(cell) != before


def test_the_command_bakes_once(
    cell: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second time it says that the light is there; `setup` then bakes nothing either."""
    times: list[str] = []

    def fake(library: object, scene: str, preview: object) -> BakedLight:
        times.append(scene)
        return quick_bake(SceneLibrary(), cell)

    monkeypatch.setattr(scene_bake, "_with_a_bar", fake)
    assert scene_bake.ensure_baked(str(cell), allow_modules=False)
    assert main(["scene", "bake", str(cell)]) == 0
    assert "baked already" in capsys.readouterr().out
    assert not scene_bake.ensure_baked(str(cell), allow_modules=False)
    assert len(times) == 1
    assert main(["scene", "bake", "--force", str(cell)]) == 0
    assert "MB" in capsys.readouterr().out
    assert len(times) == 2


def test_a_scene_without_a_room_is_not_baked(capsys: pytest.CaptureFixture[str]) -> None:
    """The command says so, and nothing is wrong."""
    assert main(["scene", "bake", "optical"]) == 0
    assert "it has no room" in capsys.readouterr().out


def test_baking_nothing_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """Neither names nor --all."""
    assert main(["scene", "bake"]) == 2
    assert "or --all" in capsys.readouterr().err
