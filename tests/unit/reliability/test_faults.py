"""Every call to the disk fails once: what was there is there, what was promised is there.

As SQLite's tests do: an action is repeated, each time another of its calls fails, until none does.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from sailenv_bench.experiments.results import load_result, save_result
from sailenv_ros.assets.folders import own_pack_folder
from sailenv_ros.assets.own_pack import add_to_own_pack
from sailenv_ros.assets.pack import PACK_FILE, AssetPack
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.formats.data_files import write_bytes, write_png
from sailenv_ros.dataset.identity import WorkIdentity
from sailenv_ros.dataset.store import ResumableStore
from sailenv_ros.errors import RecordingError, SailenvError
from sailenv_ros.light.bake.light_files import load_baked, store_baked
from sailenv_ros.recording.bag_recovery import recover
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.topics import OfferedQos, RecordedTopic, RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.scene.user_scenes import write_scene
from sailenv_ros.simulation.models import thumbnails
from sailenv_ros.simulation.models.uploads import asset_from_upload
from sailenv_ros.system.files import UNFINISHED
from sailenv_ros.types.baked_light import BakedLight, LightLayer, ProbeGrid
from tests.support.faulty_disk import FaultyDisk, Kind, after_power_loss
from tests.support.upload_files import box_zip

KINDS: tuple[Kind, ...] = ("full", "broken", "short")
MESSAGES = 8


@dataclass(frozen=True)
class Action:
    """Something that writes.

    `before` makes what is there, `act` writes, `check` says whether all is well: given the folder,
    whether `act` returned, and what it returned.
    """

    before: Callable[[Path], object]
    act: Callable[[Path], object]
    check: Callable[[Path, bool, object], None]
    may_fail: tuple[type[Exception], ...] = (SailenvError,)


# -- scenes --------------------------------------------------------------------------------


def check_scene(folder: Path, done: bool, _: object) -> None:
    text = (folder / "scenes" / "den.yaml").read_text()
    assert text in (("new",) if done else ("old", "new"))


def check_new_scene(folder: Path, done: bool, _: object) -> None:
    path = folder / "scenes" / "new.yaml"
    assert not done or path.is_file()
    assert not path.exists() or path.read_text() == "new"


def scene(name: str, text: str, *, overwrite: bool) -> Callable[[Path], object]:
    return lambda folder: write_scene(folder / "scenes", name, text, overwrite=overwrite)


# -- packs ---------------------------------------------------------------------------------


def add(name: str, solid: str) -> None:
    import dataclasses

    from sailenv_ros.types.model import ConvexShape

    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (0.0, 2.0)])
    asset = dataclasses.replace(
        Primitives().load(solid),
        name=name,
        display_name=name.title(),
        category="box",
        collision=(ConvexShape(points=corners),),
    )
    add_to_own_pack(asset)


def check_pack(folder: Path, done: bool, _: object) -> None:
    if not (own_pack_folder() / PACK_FILE).exists():
        assert not done
        return
    pack = AssetPack(own_pack_folder())
    assert not pack.problems()
    triangles = pack.load("thing").model.triangle_count
    assert triangles > 100 or (not done and triangles == 12)


# -- light, thumbnails, results ------------------------------------------------------------


def light(number: float) -> BakedLight:
    """Return baked light of a few bytes."""
    texels = np.full((2, 2), number, np.float16)
    probes = np.full((1, 1, 1, 4, 3), number, np.float16)
    layer = LightLayer(
        light=None,
        direct=texels,
        bounced=np.full((2, 2, 3), number, np.float16),
        probe_direct=probes,
        probe_bounced=probes,
        visibility=None,
        clear=1.0,
    )
    grid = ProbeGrid(origin_m=(0.0, 0.0, 0.0), spacing_m=(1.0, 1.0, 1.0), shape=(1, 1, 1))
    return BakedLight(fingerprint="a" * 32, charts={}, layers=(layer,), probes=grid)


def check_light(folder: Path, done: bool, _: object) -> None:
    found = load_baked("a" * 32)
    assert found is not None
    assert float(found.layers[0].direct.max()) in ((2.0,) if done else (1.0, 2.0))


def check_thumbnail(folder: Path, done: bool, _: object) -> None:
    path = folder / "cache" / "thumbnails" / "a.png"
    assert done  # a picture that cannot be kept is no failure
    assert not path.exists() or path.read_bytes() in (b"one", b"two")


def check_result(folder: Path, done: bool, _: object) -> None:
    found = load_result(folder / "results", "flow_speed")
    assert found is not None
    assert found["data"] in (({"n": 2},) if done else ({"n": 1}, {"n": 2}))


def check_picture(folder: Path, done: bool, _: object) -> None:
    import cv2

    path = folder / "set" / "1.png"
    assert not done or path.is_file()
    assert not path.exists() or cv2.imread(str(path)).shape == (4, 4, 3)


# -- recordings ----------------------------------------------------------------------------


def record(folder: Path) -> RecordingWriter:
    """Write messages into several files; return the writer, which tells what was lost."""
    writer = RecordingWriter(folder / "bag", RecordingOptions(chunk_bytes=400, split_bytes=900))
    topic = RecordedTopic(name="/a", type="std_msgs/msg/String", schema="", qos=OfferedQos())
    writer.add_topic(topic)
    with suppress(RecordingError):  # the writer tells of it again, in figures
        for number in range(MESSAGES):
            writer.write("/a", (b"\0\1\0\0" + bytes([number]) * 300,), number + 1)
    writer.close()
    return writer


def check_recording(folder: Path, done: bool, writer: object) -> None:
    """What can be read is what was sent, in its order; what is missing is counted as lost."""
    if not (folder / "bag").exists() or not list((folder / "bag").glob("*.mcap")):
        assert not done
        return
    try:
        found = messages(folder / "bag")
    except RecordingError:
        try:
            recover(folder / "bag")
            found = messages(folder / "bag")
        except RecordingError:
            found = []  # not even the file's first bytes could be written
            assert not done
    numbers = [message[0] for message in found]
    assert found == [bytes([number]) * 300 for number in numbers]
    assert numbers == sorted(set(numbers))
    if done:
        assert isinstance(writer, RecordingWriter)
        statistics = writer.statistics
        assert len(found) + statistics.lost == statistics.messages


def messages(bag: Path) -> list[bytes]:
    with RecordingReader(bag) as reader:
        return [bytes(raw.data[4:]) for _, raw in reader.messages()]


# -- uploads -------------------------------------------------------------------------------


def upload(folder: Path) -> object:
    return asset_from_upload(box_zip(), name="", filename="box.zip")


def check_upload(folder: Path, done: bool, _: object) -> None:
    assert not list((folder / "tmp").iterdir())


# -- works that are gone on with -------------------------------------------------------------


def work(folder: Path) -> ResumableStore:
    identity = WorkIdentity(file="begun.json", settings={"seed": 1})
    return ResumableStore(FolderStorage(folder / "set"), identity)


def make_part(number: int) -> Callable[[Path], object]:
    """Make a part of two files in a staging folder, and a note of it."""

    def act(folder: Path) -> None:
        store = work(folder)
        with store.opened(), store.part() as part:
            for name in (f"{number}.txt", f"deep/{number}.txt"):
                write_bytes(part.folder / name, b"whole")
            part.note = f"notes/{number}.json", b"noted"

    return act


def note_part(number: int) -> Callable[[Path], object]:
    """Write two files to their places, and a note of them."""

    def act(folder: Path) -> None:
        store = work(folder)
        with store.opened():
            for name in (f"{number}.txt", f"deep/{number}.txt"):
                write_bytes(folder / "set" / name, b"whole")
            store.note(f"notes/{number}.json", b"noted")

    return act


def check_parts(folder: Path, done: bool, _: object) -> None:
    """What is noted is whole, and its work is known; what was noted before still is."""
    notes = work(folder).notes("notes")
    assert {"0.json", "1.json"} >= set(notes) >= ({"0.json", "1.json"} if done else {"0.json"})
    assert work(folder).check()
    for name, data in notes.items():
        assert data == b"noted"
        for path in (f"{name[0]}.txt", f"deep/{name[0]}.txt"):
            assert (folder / "set" / path).read_bytes() == b"whole"


def finish_work(folder: Path) -> None:
    store = work(folder)
    if (folder / "set" / "begun.json").exists():
        with store.opened():
            store.finish(["notes/0.json", "begun.json"])


def check_finished(folder: Path, done: bool, _: object) -> None:
    """What was made stays; it is known as finished, or can be gone on with."""
    assert (folder / "set" / "deep" / "0.txt").read_bytes() == b"whole"
    assert not done or not (folder / "set" / "begun.json").exists()


ACTIONS = {
    "a scene that is there": Action(
        scene("den", "old", overwrite=False), scene("den", "new", overwrite=True), check_scene
    ),
    "a new scene": Action(
        lambda folder: None, scene("new", "new", overwrite=False), check_new_scene
    ),
    "an asset that is there": Action(
        lambda folder: add("thing", "cube"), lambda folder: add("thing", "sphere"), check_pack
    ),
    "a first asset": Action(
        lambda folder: None, lambda folder: add("thing", "sphere"), check_pack
    ),
    "baked light": Action(
        lambda folder: store_baked(light(1.0)), lambda folder: store_baked(light(2.0)), check_light
    ),
    "a thumbnail": Action(
        lambda folder: thumbnails._keep(thumbnails.thumbnail_folder() / "a.png", b"one"),
        lambda folder: thumbnails._keep(thumbnails.thumbnail_folder() / "a.png", b"two"),
        check_thumbnail,
        may_fail=(),
    ),
    "a result": Action(
        lambda folder: save_result(folder / "results", "flow_speed", {}, {"n": 1}),
        lambda folder: save_result(folder / "results", "flow_speed", {}, {"n": 2}),
        check_result,
    ),
    "an exported picture": Action(
        lambda folder: None,
        lambda folder: write_png(folder / "set" / "1.png", np.zeros((4, 4, 3), np.uint8)),
        check_picture,
    ),
    "a recording": Action(lambda folder: None, record, check_recording),
    "a part of a work": Action(make_part(0), make_part(1), check_parts),
    "a note of a work": Action(make_part(0), note_part(1), check_parts),
    "the end of a work": Action(make_part(0), finish_work, check_finished),
    "an upload": Action(lambda folder: None, upload, check_upload),
}  # fmt: skip


@pytest.fixture
def folder(memory_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that everything is written to."""
    home = memory_folder / "home"
    (home / "tmp").mkdir(parents=True)
    monkeypatch.setenv("SAILENV_CACHE", str(home / "cache"))
    monkeypatch.setenv("XDG_DATA_HOME", str(home / "data"))
    monkeypatch.setattr(tempfile, "tempdir", str(home / "tmp"))
    return home


def run(action: Action, folder: Path, fail_at: int, kind: Kind) -> tuple[FaultyDisk, bool, object]:
    """Do it on a disk whose call `fail_at` fails; say whether it returned, and what."""
    result: object = None
    told = ""
    with FaultyDisk(folder, fail_at=fail_at, kind=kind) as disk:
        try:
            result = action.act(folder)
            done = True
        except action.may_fail as problem:
            told = str(problem)
            done = False
    assert done or (told and "\n" not in told)
    return disk, done, result


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("what", ACTIONS)
def test_each_call_may_fail(folder: Path, memory_folder: Path, what: str, kind: Kind) -> None:
    """A sentence, nothing half written, and the next attempt succeeds."""
    action = ACTIONS[what]
    action.before(folder)
    start = memory_folder / "start"
    shutil.copytree(folder, start)
    fail_at = 0
    while True:
        fail_at += 1
        shutil.rmtree(folder)
        shutil.copytree(start, folder)
        disk, done, result = run(action, folder, fail_at, kind)
        if not disk.failed:
            assert done
            action.check(folder, True, result)
            break
        action.check(folder, done, result)
        assert not [path for path in folder.rglob(f"*{UNFINISHED}*") if disk.failed]
        if what != "a recording":  # which is never written over
            _, done, result = run(action, folder, 0, kind)
            assert done
            action.check(folder, True, result)
    assert fail_at > (3 if what != "an upload" else 2)


@pytest.mark.parametrize(
    "what", ["a scene that is there", "a new scene", "an asset that is there", "baked light",
             "a result", "a recording", "a part of a work", "a note of a work",
             "the end of a work"],
)  # fmt: skip
def test_power_may_be_lost_at_any_time(folder: Path, memory_folder: Path, what: str) -> None:
    """Whatever of the unsynced bytes and names is on the disk; what returned is there for good."""
    action = ACTIONS[what]
    action.before(folder)
    start = memory_folder / "start"
    shutil.copytree(folder, start)
    disk, done, result = run(action, folder, 0, "full")
    assert done
    states = 0
    for steps, _, _ in after_power_loss(start, disk.log, folder):
        action.check(folder, steps == len(disk.log), result)
        states += 1
    assert states >= 20
