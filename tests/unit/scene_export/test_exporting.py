"""Files of exports: refused names change nothing, a full disk leaves what was there."""

from __future__ import annotations

import errno
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros import Simulation, export_asset, export_scene
from sailenv_ros.cli.main import main
from sailenv_ros.errors import InvalidRequest, StorageError, UnknownName
from sailenv_ros.scene_export import saving
from sailenv_ros.scene_export.contents import Written
from sailenv_ros.scene_export.formats import ASSET_FORMATS, SCENE_FORMATS
from sailenv_ros.scene_export.saving import save
from tests.unit.scene_export.test_glb import Glb


@pytest.mark.parametrize("name", ["room.obj", "room", "room.glb.zip"])
def test_other_formats_are_refused(name: str, scene_file: Path, tmp_path: Path) -> None:
    """The sentence names those that there are."""
    with pytest.raises(InvalidRequest, match=r"ends in one of: \.glb"):
        export_scene(scene_file, tmp_path / name)
    assert not any(tmp_path.iterdir())


def test_a_format_of_single_objects_is_explained(scene_file: Path, tmp_path: Path) -> None:
    with pytest.raises(InvalidRequest, match=r"\.urdf holds one object, see `sailenv assets exp"):
        export_scene(scene_file, tmp_path / "room.urdf")


def test_unknown_scenes_and_assets_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="scene"):
        export_scene("no_room", tmp_path / "room.glb")
    with pytest.raises(UnknownName, match="style"):
        export_asset("chair~throne:1", tmp_path / "chair.glb")
    assert not any(tmp_path.iterdir())


def test_a_file_is_replaced_on_request_alone(scene_file: Path, tmp_path: Path) -> None:
    file = tmp_path / "little.glb"
    file.write_bytes(b"mine")
    with pytest.raises(InvalidRequest, match="to be overwritten"):
        export_scene(scene_file, file)
    assert file.read_bytes() == b"mine"
    report = export_scene(scene_file, file, overwrite=True)
    assert report.size_bytes == file.stat().st_size > 10_000
    assert (report.objects, report.folder) == (11, None)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["little.glb"]


def test_a_folder_that_is_missing_is_refused(scene_file: Path, tmp_path: Path) -> None:
    with pytest.raises(InvalidRequest, match="one that exists"):
        export_scene(scene_file, tmp_path / "no" / "little.glb")


def test_a_later_moment_is_written(scene_file: Path, tmp_path: Path) -> None:
    """A thing that falls is lower; the time has bounds."""
    text = scene_file.read_text(encoding="utf-8")
    high = tmp_path / "high.yaml"
    high.write_text(text.replace("[0, 0, 0.15], scale", "[0, 0, 3.0], scale"), encoding="utf-8")
    sizes = []
    for at_s in (0.0, 0.3):
        file = tmp_path / f"at_{at_s}.glb"
        export_scene(high, file, at_s=at_s)
        sizes.append(file.read_bytes())
    assert sizes[0] != sizes[1]
    with pytest.raises(InvalidRequest, match="at_s"):
        export_scene(high, tmp_path / "late.glb", at_s=1e9)


@pytest.mark.parametrize("place", ["file", "folder"])
def test_a_full_disk_leaves_what_was_there(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both the file and the folder beside it, whichever is written when the disk is full."""
    path, beside = tmp_path / "room.xml", tmp_path / "room_xml"
    save(Written(data=b"old", beside={"a.obj": b"old"}), path, beside)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    if place == "file":
        monkeypatch.setattr("sailenv_ros.system.files.os.fsync", full)
    else:
        monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(StorageError, match="disk is full"):
        save(Written(data=b"new", beside={"b.obj": b"new"}), path, beside)
    monkeypatch.undo()
    assert path.read_bytes() == b"old"
    assert [file.name for file in beside.iterdir()] == ["a.obj"]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["room.xml", "room_xml"]


def test_the_commands_say_what_was_written_and_lost(
    scene_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room, chair = tmp_path / "little.glb", tmp_path / "chair.glb"
    assert main(["scene", "export", str(scene_file), "-o", str(room)]) == 0
    said = capsys.readouterr().out
    assert "11 objects" in said
    assert "lost: the lenses of 1 camera" in said
    assert main(["assets", "export", "chair~dining:17", "-o", str(chair)]) == 0
    assert "1 object" in capsys.readouterr().out
    assert main(["scene", "export", str(scene_file), "-o", str(room)]) == 2
    assert "to be overwritten" in capsys.readouterr().err


def test_every_format_is_told_of(tmp_path: Path) -> None:
    """The page has a row for each."""
    page = Path(__file__).resolve().parents[3] / "docs" / "export.md"
    text = page.read_text(encoding="utf-8")
    assert all(f"`{suffix}`" in text for suffix in {*SCENE_FORMATS, *ASSET_FORMATS})
    assert saving.__all__


def test_a_running_simulation_is_written_as_it_is_now(scene_file: Path, tmp_path: Path) -> None:
    """With what was moved, added and taken out, and with the cameras that look at it."""
    with Simulation(scene_file, mode="lockstep") as simulation:
        simulation.despawn_object("can")
        simulation.spawn_object("cube", (0.5, -0.25, 0.75), object_name="newcomer", scale=0.2)
        simulation.set_position((2.0, 1.0, 1.75), agent="eye", teleport=True)
        report = export_scene(simulation, tmp_path / "now.glb")
        with pytest.raises(InvalidRequest, match="as it is now"):
            export_scene(simulation, tmp_path / "later.glb", at_s=1.0)
    seen = Glb(report.file.read_bytes())
    assert "can" not in seen.nodes
    np.testing.assert_allclose(seen.pose("newcomer")[:3, 3], (0.5, -0.25, 0.75))
    np.testing.assert_allclose(seen.pose("eye")[:3, 3], (2.0, 1.0, 1.75))
    assert not (tmp_path / "later.glb").exists()
