"""The one store: whole or not there, one at a time, and the same in the end after any break."""

from __future__ import annotations

import fcntl
import json
import shutil
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sailenv_ros.dataset import folder_storage
from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.formats import DatasetWriter, journal
from sailenv_ros.dataset.identity import WorkIdentity
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.storage import Storage
from sailenv_ros.dataset.store import ResumableStore
from sailenv_ros.dataset.streams.parts import StreamFolder
from sailenv_ros.errors import BegunOtherwise, DeadlineExceeded, PlaceTaken, WriteFailed
from sailenv_ros.recording.topics import OfferedQos, RecordedTopic
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.system.files import UNFINISHED
from tests.support.killing_disk import killed_at
from tests.support.recordings import noise_frame

SETTINGS: dict[str, Any] = {"seed": 1, "views": ["rgb"], "clip": {"frames": 3}, "cameras": [{}]}
PARTS = 3


def store_in(folder: Path, **changes: Any) -> ResumableStore:
    identity = WorkIdentity(file="begun.json", settings={**SETTINGS, **changes})
    return ResumableStore(FolderStorage(folder), identity)


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


# -- identity ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"seed": 2}, "seed is 1, not 2"),
        ({"views": ["rgb", "depth"]}, r"views is \['rgb'\], not \['rgb', 'depth'\]"),
        ({"clip": {"frames": 4}}, r"clip\.frames is 3, not 4"),
        ({"clip": {}}, r"clip\.frames is 3, not None"),
        ({"cameras": [{"width": 8}]}, r"cameras\[0\]\.width is None, not 8"),
        ({"cameras": []}, r"cameras is \[\{\}\], not \[\]"),
        ({"gap": 1.5}, "gap is None, not 1.5"),
        ({"seed": 2, "views": [], "clip": {}, "gap": 1}, "None, and 1 more; choose another"),
    ],
)
def test_the_setting_that_differs_is_named(
    tmp_path: Path, changes: dict[str, Any], told: str
) -> None:
    """As it is there and as it was asked for; nothing is written."""
    with store_in(tmp_path).opened():
        pass
    before = contents(tmp_path)
    with (
        pytest.raises(BegunOtherwise, match=f"was begun otherwise: .*{told}"),
        store_in(tmp_path, **changes).opened(),
    ):
        pass
    assert contents(tmp_path) == before


def test_a_setting_that_only_the_folder_has_is_no_difference(tmp_path: Path) -> None:
    """A first look may know fewer settings than the work has; tuples are lists."""
    with store_in(tmp_path, light="baked").opened():
        pass
    assert store_in(tmp_path, views=("rgb",)).check()


def test_settings_within_a_document(tmp_path: Path) -> None:
    """The file may tell more than what is compared."""

    def identity(seed: int, told: str) -> WorkIdentity:
        settings = {"seed": seed}
        document = json.dumps({"head": settings, "told": told}).encode()
        return WorkIdentity(file="a/b.json", settings=settings, document=document, key="head")

    storage = FolderStorage(tmp_path)
    with ResumableStore(storage, identity(1, "first")).opened():
        pass
    assert ResumableStore(storage, identity(1, "second")).check()
    assert json.loads((tmp_path / "a/b.json").read_text())["told"] == "first"
    with pytest.raises(BegunOtherwise) as problem:
        ResumableStore(storage, identity(2, "first")).check()
    assert problem.value.differing == {"seed": (1, 2)}
    assert problem.value.place == str(tmp_path)


@pytest.mark.parametrize("content", [b"", b"{", b"[1]", b"3", b"\xff", b"[" * 100_000])
def test_a_file_of_something_else_is_no_identity(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "begun.json").write_bytes(content)
    with pytest.raises(PlaceTaken, match=r"begun\.json of something else"):
        store_in(tmp_path).check()
    assert contents(tmp_path) == {"begun.json": content}


# -- places --------------------------------------------------------------------------------


def test_folders_of_others_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(PlaceTaken, match="is not empty"), store_in(tmp_path).opened():
        pass
    with pytest.raises(PlaceTaken, match="is no folder"), store_in(tmp_path / "mine.txt").opened():
        pass
    with pytest.raises(WriteFailed), store_in(tmp_path / "mine.txt" / "set").opened():
        pass
    assert contents(tmp_path) == {"mine.txt": b"mine"}


def test_looking_makes_nothing(tmp_path: Path) -> None:
    assert not store_in(tmp_path / "set").check()
    assert store_in(tmp_path / "set").notes("notes") == {}
    assert not (tmp_path / "set").exists()


def test_what_was_begun_is_not_begun_anew(tmp_path: Path) -> None:
    """Unless it is asked to go on."""
    with store_in(tmp_path).opened(resume=False):
        pass
    with pytest.raises(PlaceTaken, match="is not empty"):
        store_in(tmp_path).check(resume=False)


def test_one_works_there_at_a_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Others wait, and are told; when the lock's file was removed meanwhile they are alone too."""
    monkeypatch.setattr(folder_storage, "LOCK_TIMEOUT_S", 0.1)
    first = store_in(tmp_path)
    with first.opened():
        with pytest.raises(DeadlineExceeded, match=str(tmp_path)), store_in(tmp_path).opened():
            pass
        monkeypatch.setattr(folder_storage, "LOCK_TIMEOUT_S", 60.0)
        entered, checked = threading.Event(), threading.Event()

        def second() -> None:
            with store_in(tmp_path).opened():
                entered.set()
                with (tmp_path / ".lock").open() as lock, pytest.raises(BlockingIOError):
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                checked.set()

        thread = threading.Thread(target=second)
        thread.start()
        first.finish()
    thread.join(60.0)
    assert entered.is_set()
    assert checked.is_set()


def test_a_part_is_there_with_its_note_or_not_at_all(tmp_path: Path) -> None:
    """Whatever ends it; what a killed writer left goes when the next one opens the place."""
    store = store_in(tmp_path)

    def break_off() -> None:
        with store.part() as part:
            (part.folder / "0.txt").write_text("half")
            part.note = "notes/0.json", b"{}"
            raise KeyboardInterrupt

    with store.opened():
        with pytest.raises(KeyboardInterrupt):
            break_off()
        assert sorted(contents(tmp_path)) == [".lock", "begun.json"]
        with store.part() as part:
            (part.folder / "deep").mkdir()
            (part.folder / "deep" / "0.txt").write_text("whole")
            part.note = "notes/0.json", b"{}"
        assert store.notes("notes") == {"0.json": b"{}"}
    left = (tmp_path / f"making{UNFINISHED}" / "x", tmp_path / "deep")
    for folder in left:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f".1.txt.abc{UNFINISHED}").write_text("half")
    with store.opened():
        store.finish()
    assert contents(tmp_path).keys() == {"begun.json", "deep/0.txt", "notes/0.json"}


def test_notes_are_forgotten_in_the_end(tmp_path: Path) -> None:
    """With their folders."""
    store = store_in(tmp_path)
    with store.opened():
        (tmp_path / "one.txt").write_text("whole")
        store.note("unfinished/notes/0.json", b"{}")
        store.finish(["unfinished/notes/0.json", "begun.json"])
    assert contents(tmp_path) == {"one.txt": b"whole"}
    assert [path.name for path in tmp_path.iterdir()] == ["one.txt"]


@pytest.mark.parametrize("where", ["folder", "remote"])
def test_every_place_keeps_the_same(tmp_path: Path, where: str) -> None:
    """A folder and a place that `fsspec` reaches: parts, notes, identity, removal."""
    storage: Storage = FolderStorage(tmp_path)
    if where == "remote":
        storage = open_storage(f"memory://{tmp_path.name}/set")
    identity = WorkIdentity(file="begun.json", settings={"seed": 1})
    store = ResumableStore(storage, identity)
    assert not store.check()
    with store.opened():
        for number in range(2):
            with store.part() as part:
                (part.folder / f"{number}.txt").write_text(str(number))
                part.note = f"notes/{number}.json", b"{}"
        assert list(store.notes("notes")) == ["0.json", "1.json"]
        assert (storage.read("1.txt"), storage.read("2.txt")) == (b"1", None)
        assert store.check()
        with pytest.raises(BegunOtherwise):
            ResumableStore(storage, WorkIdentity(file="begun.json", settings={"seed": 2})).check()
        store.finish(["notes/1.json", "notes/0.json"])
    assert store.notes("notes") == {}
    assert store.check()


# -- killed at any moment ------------------------------------------------------------------


def make_parts(folder: Path) -> None:
    """A work of parts, which keeps its identity and its notes, as a data set by recipe does."""
    store = store_in(folder)
    with store.opened():
        done = store.notes("notes")
        for number in range(PARTS):
            if f"{number}.json" not in done:
                with store.part() as part:
                    (part.folder / "deep").mkdir()
                    (part.folder / "deep" / f"{number}.txt").write_text(str(number))
                    part.note = f"notes/{number}.json", b"{}"
        store.finish()


def write_dataset(folder: Path) -> None:
    """An export, which forgets its notes in the end."""
    try:
        with DatasetWriter(folder, ["flo", "png"], resume=True) as writer:
            for number in range(writer.done, PARTS):
                writer.add(noise_frame(number + 1, views=("rgb", "flow")))
    except PlaceTaken:
        assert (folder / "export.json").is_file()
        (folder / ".lock").unlink(missing_ok=True)


def make_stream(folder: Path) -> None:
    """A stream's bag, which grows beside its place."""
    stream = StreamFolder(folder / "stream", {"seed": 1})
    topic = RecordedTopic(name="/a", type="std_msgs/msg/String", schema="", qos=OfferedQos())
    with stream.opened():
        if stream.is_whole:
            return
        for number in stream.missing(PARTS):
            with stream.part(number) as draft, RecordingWriter(draft) as writer:
                writer.add_topic(topic)
                writer.write("/a", (b"\0\1\0\0" + bytes([number]) * 30,), number + 1)
        stream.finish()


@pytest.mark.timeout(600)
@pytest.mark.parametrize("work", [make_parts, write_dataset, make_stream])
def test_what_was_killed_at_any_call_ends_as_if_it_was_not(
    work: Callable[[Path], None], memory_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`kill -9` at each call to the disk; the same call then ends with the same files alone."""
    monkeypatch.setattr(journal, "FRAMES_PER_NOTE", 2)
    work(memory_folder / "whole")
    wanted = contents(memory_folder / "whole")
    folder = memory_folder / "killed"
    call = 1
    while killed_at(call, folder, lambda: work(folder)):
        work(folder)
        assert contents(folder) == wanted, f"killed at call {call}"
        work(folder)
        assert contents(folder) == wanted, f"killed at call {call}, made again"
        shutil.rmtree(folder)
        call += 1
    assert call > 40
    assert contents(folder) == wanted
