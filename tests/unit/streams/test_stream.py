"""Streams: any frame by its number has the bytes that it has when all before it were made."""

from __future__ import annotations

import gc
import hashlib
import multiprocessing
import pickle
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sailenv_ros.streams as streams
from sailenv_ros.errors import InvalidRequest, SceneError, UnknownName
from sailenv_ros.render.contract import RenderedViews
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.streams import Course, Stream, StreamFrame
from sailenv_ros.streams.plan import HABITS, StreamPlan
from sailenv_ros.streams.player import Player
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.world import World

ORDER = (29, 3, 4, 17, 16, 5, 98, 12, 12, 0, 30)
"""Ahead, back, across episodes and rooms, twice the same."""

DEADLINE_S = 60.0
"""Time in which a process makes some frames [s]."""


def _bytes(frame: StreamFrame) -> str:
    digest = hashlib.sha256()
    for name, view in frame.views.items():
        digest.update(name.encode() + view.tobytes())
    return digest.hexdigest()


def _all_bytes(stream: Stream) -> list[str]:
    return [_bytes(frame) for frame in stream]


def _digests(stream: Stream) -> dict[int, str]:
    return {number: _bytes(stream[number]) for number in ORDER}


@pytest.fixture(scope="module")
def in_order(stream: Stream) -> dict[int, str]:
    return {frame.number: _bytes(frame) for frame in stream}


def test_a_frame_by_its_number_is_that_of_the_whole_stream(
    stream: Stream, in_order: dict[int, str]
) -> None:
    for number in ORDER:
        assert _bytes(stream[number]) == in_order[number], number
    assert len(set(in_order.values())) > 90  # a camera that stands may see the same twice


def test_another_process_makes_the_same(stream: Stream, in_order: dict[int, str]) -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        found = pool.apply(_digests, (pickle.loads(pickle.dumps(stream)),))
    assert found == {number: in_order[number] for number in ORDER}


def test_a_forked_process_makes_a_simulation_of_its_own(
    stream: Stream, in_order: dict[int, str]
) -> None:
    """Forked from a process that has nothing else in it: threads of others do not survive one."""
    context = multiprocessing.get_context("spawn")
    found = context.SimpleQueue()
    process = context.Process(target=_fork, args=(stream, found))
    process.start()
    process.join(DEADLINE_S)
    assert process.exitcode == 0
    assert found.get() == (in_order[8], in_order[8])


def _fork(stream: Stream, found: Any) -> None:
    stream[7]
    with multiprocessing.get_context("fork").Pool(1) as pool:
        forked = pool.apply(_digest_of, (stream, 8))
    found.put((forked, _bytes(stream[8])))


def _digest_of(stream: Stream, number: int) -> str:
    return _bytes(stream[number])


def test_slices_are_streams(stream: Stream, in_order: dict[int, str]) -> None:
    part = stream[20:30:3]
    assert [frame.number for frame in part] == [20, 23, 26, 29]
    assert _bytes(part[-1]) == in_order[29]
    assert (len(part), len(part[1:])) == (4, 3)
    part.close()
    with pytest.raises(IndexError):
        stream[100]


def test_parts_of_a_stream_share_its_simulation(
    course: Course, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One for all that a thread reads; with the last of them it is freed, closed or not."""
    made, closed = [], []

    class Counted(Player):
        def __init__(self, *given: Any) -> None:
            super().__init__(*given)
            made.append(threading.get_ident())

        def close(self) -> None:
            closed.append(id(self))
            super().close()

    monkeypatch.setattr("sailenv_ros.streams.stream.Player", Counted)
    whole = streams.open(course, length=100)
    digests = [_all_bytes(whole[first : first + 2]) for first in (0, 12, 24)]
    part = whole[24:26]
    assert _all_bytes(part) == digests[-1]
    assert (len(made), closed) == (1, [])
    with ThreadPoolExecutor(1) as other:
        assert other.submit(_all_bytes, part).result() == digests[-1]
    assert len(set(made)) == len(made) == 2
    del whole
    gc.collect()
    assert not closed
    del part
    gc.collect()
    assert len(set(closed)) == 2


def test_a_room_that_was_left_is_not_drawn_beside_the_next(
    course: Course, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While an episode's world is built, renderers hold at most what that shows."""
    shown: list[tuple[str, set[str]]] = []
    renderers: list[NativeRenderer] = []

    class Noted(NativeRenderer):
        def __init__(self) -> None:
            super().__init__()
            renderers.append(self)

    built = SceneLibrary.build

    def build(library: SceneLibrary, scene: str | Path, *given: Any, **more: Any) -> World:
        tables = [one.part_table.contents for one in renderers]
        kept = {contents.scene for contents in tables if contents is not None}
        world = built(library, scene, *given, **more)
        shown.append((Path(scene).stem, kept))
        return world

    monkeypatch.setattr("sailenv_ros.streams.player.NativeRenderer", Noted)
    monkeypatch.setattr(SceneLibrary, "build", build)
    with streams.open(course, seed=5, length=100) as one:
        frames = [one[number] for number in range(1, 48, 6)]
    assert len({frame.room for frame in frames}) == 2
    assert len(shown) == 8
    assert any(kept for _, kept in shown)
    assert all(kept <= {room} for room, kept in shown)


def test_a_world_is_built_beside_no_other(course: Course, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the episode before no physics are left, of the room before nothing at all."""
    left: list[tuple[str, set[str]]] = []
    clients: set[BulletClient] = set()
    libraries: weakref.WeakSet[SceneLibrary] = weakref.WeakSet()
    worlds: weakref.WeakSet[World] = weakref.WeakSet()

    class Noted(BulletClient):
        def __init__(self) -> None:
            super().__init__()
            clients.add(self)

        def close(self) -> None:
            super().close()
            clients.discard(self)

    built = SceneLibrary.build

    def build(library: SceneLibrary, scene: str | Path, *given: Any, **more: Any) -> World:
        assert not clients
        libraries.add(library)
        assert len(libraries) == 1
        left.append((Path(scene).stem, {world.scene for world in worlds}))
        world = built(library, scene, *given, **more)
        worlds.add(world)
        return world

    monkeypatch.setattr("sailenv_ros.world.world_state.BulletClient", Noted)
    monkeypatch.setattr(SceneLibrary, "build", build)
    with streams.open(course, seed=5, length=100) as one:
        rooms = [one[number].room for number in range(1, 48, 6)]
        assert len(clients) == 1
    assert not clients
    assert [Path(room).stem for room in rooms] == [room for room, _ in left]
    assert any(others for _, others in left)
    assert all(others <= {room} for room, others in left)


def test_a_frame_outlives_its_room(course: Course) -> None:
    """Objects of a kept frame are drawn alone as they were, whatever is played after it."""
    with streams.open(course, seed=5, length=100) as one:
        kept = one[3], one[4]
        before = kept[0].frame.amodal
        assert one[13].room != kept[0].room
        after = kept[1].frame.amodal
    with streams.open(course, seed=5, length=100) as one:
        other = one[3], one[4]
    for frame, found in zip(other, (before, after), strict=True):
        expected = frame.frame.amodal
        np.testing.assert_array_equal(found.ids, expected.ids)
        np.testing.assert_array_equal(found.whole_pixels, expected.whole_pixels)
    assert before.whole_pixels.any()


def test_a_room_is_drawn_for_its_frames_alone(
    course: Course, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not before it is furnished and painted: both would be in memory, and be made twice."""
    drawn: list[int] = []
    render = NativeRenderer.render_all

    def noted(renderer: NativeRenderer, *given: Any, **more: Any) -> list[RenderedViews]:
        drawn.append(number)
        return render(renderer, *given, **more)

    monkeypatch.setattr(NativeRenderer, "render_all", noted)
    with streams.open(course, seed=5, length=100) as one:
        rooms = set()
        for number in range(0, 96, 12):
            rooms.add(one[number].room)
    assert len(rooms) == 2
    assert drawn == list(range(0, 96, 12))


def test_seeds_make_different_streams(course: Course, in_order: dict[int, str]) -> None:
    with streams.open(course, seed=6, length=100) as other:
        assert _bytes(other[29]) != in_order[29]


def test_people_of_a_course_live_in_each_episode(course_file: Path, tmp_path: Path) -> None:
    """They are drawn for each episode, move, and are the same by number and in order."""
    path = tmp_path / "lived_in.yaml"
    people = "{type: people, name: person, count: 1, activity: [walk], assets: [person_03]}"
    path.write_text(course_file.read_text() + f"randomise: [{people}]\n")
    with streams.open(streams.load_course(path), seed=5, length=100) as one:
        played = {number: one[number] for number in range(12)}
        again = _bytes(one[4])
    assert again == _bytes(played[4])
    places = [
        frame.objects.world_from_object[frame.objects.names.index("person 1")][:3, 3].tolist()
        for frame in (played[number].frame for number in (0, 5, 6))
    ]
    assert len({tuple(place) for place in places}) == 3


def test_flow_is_that_since_the_frame_before(stream: Stream) -> None:
    """Depth and poses of two frames, by arithmetic, where the room stands still."""
    with streams.open(stream.course, seed=5, views=("depth", "flow", "category"), length=60) as one:
        moving = next(n for n in range(1, 60) if one._plan.place(n).habit == "walk" and n % 6)
        before, now = one[moving - 1].frame, one[moving].frame
    walls = now.info.categories.named("wall").id
    rows, columns = np.nonzero(now.views["category"] == walls)
    depth = now.views["depth"][rows, columns].astype(np.float64)
    points = now.camera.intrinsics.rays()[rows, columns] * depth[:, None]
    move = before.camera.camera_from_world @ now.camera.world_from_camera
    was = before.camera.intrinsics.project(points @ move[:3, :3].T + move[:3, 3])
    expected = np.stack([columns, rows], axis=1) - was
    found = now.views["flow"][rows, columns] * now.dt_ns * 1e-9
    assert np.abs(expected).max() > 0.3
    np.testing.assert_allclose(found, expected, atol=1e-3)


def test_every_room_is_visited_on_each_tour(course: Course) -> None:
    plan = StreamPlan(course, 5)
    visit = course.episode * course.visit
    for tour in range(4):
        begin = tour * visit * len(plan.rooms)
        rooms = {plan.place(begin + visit * number).room for number in range(len(plan.rooms))}
        assert rooms == set(plan.rooms)
    places = [plan.place(course.episode * number) for number in range(400)]
    assert {place.habit for place in places} == set(HABITS)
    assert all(place.offset == 0 for place in places)


def test_the_courses_of_the_package_are_well() -> None:
    assert streams.courses() == ("home", "lived_in", "still_home")
    rooms = [streams.open(name, seed=3).rooms for name in streams.courses()]
    assert rooms[0] == rooms[2]
    assert len(set(rooms[0])) == 25
    assert len(streams.open()) == 10_000_000


def test_a_test_set_is_not_of_the_stream(stream: Stream) -> None:
    with stream.test_set(50, 4) as same:
        frames = list(same)
        assert len(frames) == 4
        assert {frame.room for frame in frames} <= set(stream.rooms)
        assert all(frame.drift == stream.drift(50) for frame in frames)
        own = {_bytes(stream[frame.number]) for frame in frames}
        assert own.isdisjoint(map(_bytes, frames))
        again = [_bytes(frame) for frame in stream.test_set(50, 4)]
        assert again == [_bytes(frame) for frame in frames]


def test_other_rooms_are_none_of_the_streams() -> None:
    home = streams.open("home", seed=3)
    assert set(home.rooms).isdisjoint(home.test_set(1000, 8, rooms="other").rooms)
    assert home.test_set(1000, 8).rooms == home.rooms


def test_what_is_not_accepted_is_told(stream: Stream) -> None:
    with pytest.raises(UnknownName, match="home"):
        streams.open("hom")
    with pytest.raises(InvalidRequest, match="format"):
        streams.open("home", format="torch")
    with pytest.raises(InvalidRequest, match="'same'"):
        stream.test_set(0, 4, rooms="other")
    with pytest.raises(InvalidRequest, match="length"):
        streams.open("home", length=10_000_001)


def test_arrays_are_what_a_data_loader_takes(course: Course) -> None:
    with streams.open(course, seed=5, length=10, format="arrays") as stream:
        found = stream[3]
    assert list(found) == ["number", "rgb", "category", "instance", "flow"]
    assert found["number"] == 3
    assert found["rgb"].flags.writeable
    assert found["rgb"].shape == (32, 48, 3)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("rate: 30", "rate: 0", "rate"),
        ("category: cup, begin: 12", "category: cpu, begin: 12", "did you mean 'cup'?"),
        ("begin: 0, end: 2", "begin: 0, end: 20", "from 0 to 8"),
        ("end: 24}]", "begin: 30, end: 24}]", "must be a frame after 30"),
        ("smooth_edges: false", "auto_exposure_s: 1", "is not possible in a stream"),
        ("setting: gain", "setting: jpeg_quality", "setting"),
        ("scenes: [", "kinds: [kitschen], scenes: [", "did you mean 'kitchen'?"),
        (
            "moves:",
            "randomise: [{type: material, name: m, of: floor, every: frame}]\nmoves:",
            "must be epoch in a stream",
        ),
    ],
)
def test_errors_of_a_course_have_their_place(
    course_file: Path, tmp_path: Path, old: str, new: str, told: str
) -> None:
    text = course_file.read_text()
    assert old in text
    path = tmp_path / "course.yaml"
    path.write_text(text.replace(old, new))
    with pytest.raises(SceneError) as caught:
        streams.load_course(path)
    (error,) = str(caught.value).splitlines()
    line = text.split(old)[0].count("\n") + 1
    assert error.startswith(f"{path}:{line}:")
    assert told in error
