"""Data sets written frame by frame: breaks, splits, what is told of them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sailenv_ros.cli.main import main
from sailenv_ros.dataset import folder_storage
from sailenv_ros.dataset.formats import DatasetWriter, Splits, export
from sailenv_ros.dataset.formats.journal import FRAMES_PER_NOTE, IDENTITY_FILE, NOTES_FOLDER
from sailenv_ros.errors import (
    DeadlineExceeded,
    InvalidRequest,
    InvalidState,
    PlaceTaken,
    RecordingError,
)
from sailenv_ros.frame.frame import Frame
from sailenv_ros.system.files import UNFINISHED
from tests.support.recordings import noise_frame, write_noise

pytestmark = pytest.mark.ros


def files_of(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def break_off(folder: Path, formats: list[str], frames: list[Frame]) -> None:
    """Write some frames of a data set, and be interrupted."""
    writer = DatasetWriter(folder, formats)
    for frame in frames:
        writer.add(frame)
    writer.__exit__(KeyboardInterrupt, KeyboardInterrupt(), None)


def test_a_broken_off_data_set_ends_as_one_that_was_not(tmp_path: Path) -> None:
    """Whatever was made of the frames that came before the break, each file is the same."""
    count, formats = FRAMES_PER_NOTE + 5, ["coco", "flo", "mp4"]
    frames = [noise_frame(number) for number in range(1, count + 1)]
    with DatasetWriter(tmp_path / "whole", formats) as writer:
        for frame in frames:
            writer.add(frame)
    break_off(tmp_path / "broken", formats, frames[:7])
    # As a machine that lost power leaves it: a note that has not taken its place.
    (note,) = (tmp_path / "broken" / NOTES_FOLDER).iterdir()
    note.rename(note.with_name(f".{note.name}.abc{UNFINISHED}"))
    with DatasetWriter(tmp_path / "broken", formats, resume=True) as writer:
        assert writer.done == 0, "a video has to begin anew"
        for frame in frames[writer.done :]:
            writer.add(frame)
    assert files_of(tmp_path / "broken") == files_of(tmp_path / "whole")


def test_what_is_done_is_not_asked_for_again(tmp_path: Path) -> None:
    """A data set of files goes on with the frame after the last that was noted."""
    break_off(tmp_path, ["png"], [noise_frame(number) for number in range(1, 4)])
    (tmp_path / "depth" / "000001.png").unlink()
    with DatasetWriter(tmp_path, ["png"], resume=True) as writer:
        assert writer.done == 3
        writer.add(noise_frame(4))
    assert not (tmp_path / "depth" / "000001.png").exists()
    assert [r["sequence"] for r in json.loads((tmp_path / "frames.json").read_text())] == [
        1,
        2,
        3,
        4,
    ]
    with pytest.raises(InvalidState, match="finished"):
        writer.add(noise_frame(5))


def test_the_command_goes_on_where_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An export that stopped in its middle ends with all frames, if it is asked to go on."""
    write_noise(tmp_path / "bag", 5)
    whole = tmp_path / "whole"
    export(tmp_path / "bag", whole, ["coco"])

    def stop(done: int, of: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(tmp_path / "bag", tmp_path / "out", ["coco"], on_frame=stop)
    words = ["export", str(tmp_path / "bag"), "-o", str(tmp_path / "out"), "--format"]
    assert main([*words, "coco"]) == 2
    assert "is not empty" in capsys.readouterr().err
    assert main([*words, "png", "--resume"]) == 2
    assert "was begun otherwise: formats is ['coco'], not ['png']" in capsys.readouterr().err
    assert main([*words, "coco", "--resume"]) == 0
    assert files_of(tmp_path / "out") == files_of(whole)
    assert "5 frames as coco\n  coco: 5 images, 10 annotations" in capsys.readouterr().out


def test_splits_follow_from_seed_and_number(tmp_path: Path) -> None:
    """Every frame is in one split, the same for each format; another seed deals otherwise."""
    frames = [noise_frame(number, views=("rgb", "instance")) for number in range(1, 41)]
    splits = Splits((0.5, 0.25, 0.25), seed=3)
    with DatasetWriter(tmp_path, ["png", "coco"], splits=splits) as writer:
        for frame in frames:
            writer.add(frame)
    summary = writer.finish()
    assert sum(summary.splits.values()) == 40
    for split, count in summary.splits.items():
        images = json.loads((tmp_path / "coco" / split / "annotations.json").read_text())["images"]
        table = json.loads((tmp_path / "png" / split / "frames.json").read_text())
        assert [i["number"] for i in images] == [r["number"] for r in table]
        assert len(images) == len(list((tmp_path / "png" / split / "rgb").iterdir())) == count
        assert all(splits.of_frame(i["number"]) == split for i in images)
    other = Splits((0.5, 0.25, 0.25), seed=4)
    assert [other.of_frame(n) for n in range(40)] != [splits.of_frame(n) for n in range(40)]
    dealt = [splits.of_frame(n) for n in range(4000)]
    for split, share in zip(("train", "val", "test"), (0.5, 0.25, 0.25), strict=True):
        assert dealt.count(split) / 4000 == pytest.approx(share, abs=0.03)


def test_splits_that_are_none_are_refused(tmp_path: Path) -> None:
    """Shares add up to 1; a video has an order; nothing is made before that is known."""
    with pytest.raises(InvalidRequest, match="add up to 1"):
        Splits((0.5, 0.4))
    with pytest.raises(InvalidRequest, match="share of train"):
        Splits((1.5, -0.5))
    with pytest.raises(InvalidRequest, match="a sequence"):
        DatasetWriter(tmp_path / "out", ["mp4"], splits=Splits((0.5, 0.5)))
    assert not (tmp_path / "out").exists()


def test_a_frame_without_a_needed_view_is_refused_whole(tmp_path: Path) -> None:
    """Of several formats none writes it."""
    with DatasetWriter(tmp_path, ["png", "flo"]) as writer:
        writer.add(noise_frame(1))
        with pytest.raises(InvalidRequest, match="flo needs: flow"):
            writer.add(noise_frame(2, views=("rgb",)))
    assert writer.finish().frames == 1
    assert len(list((tmp_path / "png" / "rgb").iterdir())) == 1


def test_an_unreadable_journal_is_named(tmp_path: Path) -> None:
    """What is no text is refused with the file's name."""
    break_off(tmp_path, ["png"], [noise_frame(1)])
    (note,) = (tmp_path / NOTES_FOLDER).iterdir()
    for content in (b"\xff\xfe\n", b"{\n", b"{}\n", b"3\n"):
        note.write_bytes(content)
        with pytest.raises(RecordingError, match=note.name):
            DatasetWriter(tmp_path, ["png"], resume=True)
    (tmp_path / IDENTITY_FILE).write_bytes(b"{")
    with pytest.raises(PlaceTaken, match=IDENTITY_FILE):
        DatasetWriter(tmp_path, ["png"], resume=True)


def test_what_an_older_version_began_is_refused(tmp_path: Path) -> None:
    """In a sentence that says so; nothing is changed."""
    (tmp_path / "unfinished.jsonl").write_text('{"formats": ["png"]}\n')
    with pytest.raises(PlaceTaken, match="that an older version began; nothing is overwritten"):
        DatasetWriter(tmp_path, ["png"], resume=True)
    assert [path.name for path in tmp_path.iterdir()] == ["unfinished.jsonl"]


def test_two_writers_do_not_share_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second is told who is in its way; when the first has ended it goes on."""
    monkeypatch.setattr(folder_storage, "LOCK_TIMEOUT_S", 0.1)
    with DatasetWriter(tmp_path, ["png"]) as writer:
        writer.add(noise_frame(1))
        with pytest.raises(DeadlineExceeded, match="which another process writes to"):
            DatasetWriter(tmp_path, ["png"], resume=True)
        writer.close()
        with DatasetWriter(tmp_path, ["png"], resume=True) as other:
            assert other.done == 1
    assert sorted(files_of(tmp_path)) == sorted(
        ["export.json", "frames.json", *(f"{view}/000000.png" for view in noise_frame(1).views)]
    )
