"""A room is made and resized in the editor: exactly, undoably, as it reads back; by hand, too."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from playwright.sync_api import Browser, expect

from sailenv_ros.errors import InvalidEntry, InvalidRequest, NameTaken
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.operations.rooms import RoomOperations
from sailenv_ros.types.geometry import Pose
from sailenv_ros.viewer import ViewerServer
from tests.support.browser import OpenPage
from tests.support.viewer_socket import in_a_loop, page_of

SMALL_ROOM = """
version: 1
room:
  size: [4, 3, 2.6]
  openings:
    - {type: window, wall: north, at: 0.5, width: 1.4}
    - {type: window, wall: east}
    - {type: door, wall: south, at: -1.2}
objects:
  - {name: shelf, asset: cube, scale: [0.4, 0.4, 0.4], static: true, wall: east, at: 0.8}
  - {name: box, asset: cube, scale: [0.2, 0.2, 0.2], on: shelf, static: true}
  - {name: crate, asset: cube, scale: [0.3, 0.3, 0.3], position: [-1, 0.5, 0.15], static: true}
"""


def all_of(simulation: Simulation) -> dict[str, tuple[Any, ...]]:
    """Return what can be known of each object and part of the room, but for ids."""
    found = {}
    for instance in simulation.info.instances:
        state = simulation.get_object(instance.id)
        box = (instance.low_m, instance.high_m)
        found[instance.name] = (state.asset, state.category, state.pose, state.scale, box)
    return found


def room_of(simulation: Simulation) -> Any:
    """Return the room as a saved scene says it; None for none."""
    return yaml.safe_load(simulation.scene_text()).get("room")


@pytest.fixture
def empty(simulation: Simulation) -> Iterator[Simulation]:
    """A scene without a room, with time held."""
    simulation.change_scene("object_view")
    simulation.pause()
    yield simulation
    simulation.resume()


@pytest.fixture
def small(simulation: Simulation, own_scenes: Path) -> Iterator[Simulation]:
    """A small room with openings and cubes, with time held."""
    (own_scenes / "small_room.yaml").write_text(SMALL_ROOM)
    simulation.change_scene("small_room")
    simulation.pause()
    yield simulation
    simulation.resume()


def read_back(simulation: Simulation, name: str) -> dict[str, tuple[Any, ...]]:
    """Save the scene, begin it from its file; return what is in it then."""
    simulation.save_scene(name, overwrite=True)
    simulation.change_scene(name)
    return all_of(simulation)


@in_a_loop
async def test_a_made_room_is_resized_undone_and_done_again(
    server: ViewerServer, empty: Simulation
) -> None:
    """Floor and walls have the size asked for; the plane called floor gives way and comes back."""
    async with page_of(server) as page:
        states = [all_of(empty)]
        assert (await page.ask("floor_plan"))["size"] is None
        made = await page.ask("set_room", size=[5.0, 4.0, 2.5])
        assert made == {"replaced": ["floor"]}
        assert room_of(empty) == {"size": [5, 4, 2.5]}
        states.append(all_of(empty))
        ids = {instance.name: instance.id for instance in empty.info.instances}
        assert (await page.ask("set_room", size=[6.0, 3.0, 2.8])) == {"replaced": []}
        states.append(all_of(empty))
        assert {instance.name: instance.id for instance in empty.info.instances} == ids
        for state, width in zip(states[1:], (5.0, 6.0), strict=True):
            _, _, pose, _, (low, high) = state["east wall"]
            assert pose.position_m[0] + low[0] == pytest.approx(width / 2)
            _, _, pose, _, (low, high) = state["west wall"]
            assert pose.position_m[0] + high[0] == pytest.approx(-width / 2)
        plan = await page.ask("floor_plan")
        assert plan["size"] == [6, 3, 2.8]
        assert [thing["name"] for thing in plan["objects"]] == ["object"]
        corners = plan["objects"][0]["corners"]
        np.testing.assert_allclose(np.abs(corners), np.full((8, 2), 0.3), atol=1e-9)
        assert states[2]["object"] == states[0]["object"]
        for before in (states[1], states[0]):
            await page.ask("undo")
            assert all_of(empty) == before
        assert room_of(empty) is None
        for after in states[1:]:
            await page.ask("redo")
            assert all_of(empty) == after
        assert read_back(empty, "made_room") == states[2]


def test_objects_at_walls_stay_and_read_back(small: Simulation) -> None:
    """What the file puts at a wall, and what stands on it, is saved where it is now."""
    before = all_of(small)
    RoomOperations.set_room_size(small, (7.0, 5.0, 2.6))
    after = all_of(small)
    for name in ("shelf", "box", "crate"):
        assert after[name] == before[name]
    again = read_back(small, "wider_room")
    assert again.keys() == after.keys()
    for name, (asset, category, pose, *rest) in after.items():
        assert again[name][:2] == (asset, category)
        assert again[name][2].position_m == pytest.approx(pose.position_m, abs=1e-6)
        assert again[name][2].orientation_xyzw == pytest.approx(pose.orientation_xyzw, abs=1e-6)
        assert again[name][3:] == tuple(rest)


@pytest.mark.parametrize(
    ("size", "words"),
    [
        ((2.0, 3.0, 2.6), "window 1 in the north wall"),
        ((4.0, 1.1, 2.6), "window 2 in the east wall"),
        ((3.0, 3.0, 2.6), "door 1 in the south wall"),
        ((4.0, 3.0, 2.1), "window 1 in the north wall"),
        ((4.0, 3.0, 200.0), "100"),
    ],
)
def test_a_size_that_openings_do_not_fit_changes_nothing(
    small: Simulation, size: tuple[float, float, float], words: str
) -> None:
    """One sentence names the opening."""
    before, text = small.info, small.scene_text()
    with pytest.raises(InvalidRequest) as refused:
        RoomOperations.set_room_size(small, size)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
    assert small.info == before
    assert small.scene_text() == text


def test_what_was_taken_out_of_a_room(small: Simulation) -> None:
    """A ceiling stays out of a resized room; without a wall it cannot be resized."""
    small.despawn_object("ceiling")
    records = RoomOperations.set_room_size(small, (5.0, 3.0, 2.6))
    assert "ceiling" not in all_of(small)
    assert room_of(small)["ceiling"] is False
    RoomOperations.restore_room(small, *reversed(records))
    assert room_of(small)["size"] == [4, 3, 2.6]
    assert "ceiling" not in all_of(small)
    small.despawn_object("north wall")
    with pytest.raises(InvalidEntry, match="'north wall' is a part of the room"):
        RoomOperations.set_room_size(small, (5.0, 3.0, 2.6))


def test_names_of_parts_that_others_have(empty: Simulation) -> None:
    """An object that moves keeps its name: no room is made; nor taken away for one that came."""
    wall = empty.spawn_object(
        "cube", object_name="north wall", pose=Pose((0.0, 2.0, 3.0)), remove_dynamics=False
    )
    before = all_of(empty)
    with pytest.raises(NameTaken, match="north wall"):
        RoomOperations.set_room_size(empty, (5.0, 4.0, 2.5))
    assert all_of(empty) == before
    empty.despawn_object(wall)
    made = RoomOperations.set_room_size(empty, (5.0, 4.0, 2.5))
    assert room_of(empty) is not None
    RoomOperations.restore_room(empty, *reversed(made))
    empty.change_object("floor", name="ground")
    with pytest.raises(InvalidRequest, match="floor"):
        RoomOperations.restore_room(empty, *made)
    assert room_of(empty) is None


def drag(opened: OpenPage, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag from one place of the floor plan to another [m]."""
    plan = opened.page.locator("#plan")
    box, scale = plan.bounding_box(), float(plan.get_attribute("data-scale") or 0)
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    mouse = opened.page.mouse
    mouse.move(x + start[0] * scale, y - start[1] * scale)
    mouse.down()
    mouse.move(x + end[0] * scale, y - end[1] * scale, steps=3)
    mouse.up()


@pytest.mark.slow
def test_a_room_is_dragged_in_a_browser(
    browser: Browser, server: ViewerServer, empty: Simulation, own_scenes: Path
) -> None:
    """Drawn in the plan, widened by a wall and a corner, undone; a refused drag changes nothing."""
    opened = OpenPage(browser, server.url)
    opened.until(lambda: opened.frames, "a first frame")
    plan = opened.page.locator("#plan")
    opened.tab("Room")
    expect(opened.page.locator("section", has=plan)).to_contain_text("There is no room")
    drag(opened, (0.5, 0.2), (2.5, -2.0))
    expect(plan).to_have_attribute("data-size", "5 4 2.5")
    assert room_of(empty) == {"size": [5, 4, 2.5]}
    drag(opened, (2.5, 0.5), (3.0, 0.5))
    expect(plan).to_have_attribute("data-size", "6 4 2.5")
    drag(opened, (-3.0, 2.0), (-2.5, 1.5))
    expect(plan).to_have_attribute("data-size", "5 3 2.5")
    opened.page.fill("#room-z", "3")
    opened.page.keyboard.press("Enter")
    expect(plan).to_have_attribute("data-size", "5 3 3")
    assert room_of(empty) == {"size": [5, 3, 3]}
    opened.page.locator("#stage").focus()
    opened.page.keyboard.press("z")
    expect(plan).not_to_have_attribute("data-size", "5 3 3")
    (own_scenes / "small_room.yaml").write_text(SMALL_ROOM)
    empty.change_scene("small_room")
    expect(plan).to_have_attribute("data-size", "4 3 2.6")
    drag(opened, (2.0, 0.0), (1.0, 0.0))
    expect(opened.page.locator(".toast.error")).to_contain_text("window 1 in the north wall")
    expect(plan).to_have_attribute("data-size", "4 3 2.6")
    assert room_of(empty)["size"] == [4, 3, 2.6]
    opened.close()
