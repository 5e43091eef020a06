"""What is changed in the editor is undone and done again, exactly; by hand in a browser, too."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, expect

from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer import ViewerServer
from tests.support.browser import OpenPage
from tests.support.viewer_socket import in_a_loop, page_of
from tests.support.waiting import until


def by_name(simulation: Simulation) -> dict[str, tuple[Any, ...]]:
    """Return what can be known of each object, but for its id."""
    found = {}
    for instance in simulation.info.instances:
        state = simulation.get_object(instance.id)
        about = (state.asset, state.category, state.pose, state.scale, state.static)
        found[instance.name] = (*about, state.behaviours)
    return found


@pytest.fixture
def still(simulation: Simulation) -> Iterator[Simulation]:
    """The scene at its start, with time held, so that nothing but the editor changes anything."""
    simulation.change_scene("object_view")
    simulation.pause()
    yield simulation
    simulation.resume()


@in_a_loop
async def test_every_change_of_an_object_is_undone_and_done_again(
    server: ViewerServer, still: Simulation
) -> None:
    """Adding, moving, changing, deleting and behaviours: back to the start and forth to the end."""
    async with page_of(server) as page:
        states = [by_name(still)]
        made = await page.ask("spawn", asset="cube", u=80, v=90)
        states.append(by_name(still))
        number = made["id"]
        await page.ask(
            "move_object", obj=number, position=[1.0, 0.5, 0.7], rotation=[0, 0, 30], teleport=True
        )
        states.append(by_name(still))
        await page.ask("change_object", obj=number, changes={"name": "box", "scale": [2, 1, 1]})
        states.append(by_name(still))
        await page.ask("add_behaviour", obj=number, behaviour={"type": "rotate_rigidbody"})
        states.append(by_name(still))
        await page.ask("despawn_object", obj=number)
        states.append(by_name(still))
        assert states[-1].keys() == states[0].keys()
        for before in reversed(states[:-1]):
            await page.ask("undo")
            assert by_name(still) == before
        assert "nothing to undo" in await page.refusal("undo")
        for after in states[1:]:
            await page.ask("redo")
            assert by_name(still) == after
        assert "nothing to do again" in await page.refusal("redo")


@in_a_loop
async def test_robots_are_undone_as_a_whole(server: ViewerServer, still: Simulation) -> None:
    """Adding one, and deleting it by one of its links; it comes back with its joints as they were.

    A page names files of Python packages alone.
    """
    async with page_of(server) as page:
        states = [by_name(still)]
        made = await page.ask("add_robot", file="pybullet_data:r2d2.urdf", u=80, v=90, mount="free")
        assert made == still.get_robot("r2d2").links["base_link"]
        states.append(by_name(still))
        assert len(states[1]) == len(states[0]) + 16
        still.put_joints({"head_swivel": 0.5})
        bent = by_name(still)
        head = still.get_robot("r2d2").links["head"]
        await page.ask("despawn_object", obj=head)
        assert by_name(still) == states[0]
        assert (await page.ask("undo"))["what"] == "deleting r2d2"
        back = by_name(still)
        assert back.keys() == bent.keys()
        for name, (*_, pose, _, _, _) in bent.items():
            np.testing.assert_allclose(back[name][2].matrix(), pose.matrix(), atol=1e-9)
        assert still.get_robot("r2d2").mount == "free"
        await page.ask("redo")
        assert by_name(still) == states[0]
        await page.ask("undo")
        await page.ask("undo")
        assert by_name(still) == states[0]
        await page.ask("redo")
        assert "r2d2" in still.scene_text()
        await page.ask("undo")
        assert "PACKAGE:path" in await page.refusal("add_robot", file="/etc/passwd", u=8, v=9)


@in_a_loop
async def test_lights_and_surroundings_are_undone(server: ViewerServer, still: Simulation) -> None:
    """Those that were changed, and no other; quick changes of one slider are one step."""
    async with page_of(server) as page:
        lights, environment = still.info.lights, still.info.environment
        name = lights[0].name
        for intensity in (0.25, 0.5, 0.75):
            await page.ask("set_light", light_name=name, changes={"intensity": intensity})
        await page.ask("add_light", light_name="extra", light_type="point")
        await page.ask("set_environment", changes={"exposure": 2.5})
        await page.ask("undo")
        assert still.info.environment == environment
        await page.ask("undo")
        assert [light.name for light in still.info.lights] == [light.name for light in lights]
        assert still.get_light(name).intensity == 0.75
        await page.ask("undo")
        assert still.info.lights == lights
        for _ in range(3):
            await page.ask("redo")
        assert still.get_light(name).intensity == 0.75
        assert still.get_light("extra").type == "point"
        assert still.info.environment.exposure == 2.5


@in_a_loop
async def test_a_new_change_ends_what_could_be_done_again(
    server: ViewerServer, still: Simulation
) -> None:
    """And another scene ends all of it."""
    async with page_of(server) as page:
        first = await page.ask("spawn", asset="cube", u=80, v=90)
        await page.ask("undo")
        await page.ask("spawn", asset="sphere", u=80, v=90)
        assert "nothing to do again" in await page.refusal("redo")
        assert first["name"] not in {instance.name for instance in still.info.instances}
        await page.ask("reset")
        assert "nothing to undo" in await page.refusal("undo")


@in_a_loop
async def test_what_others_have_taken_away_is_told(server: ViewerServer, still: Simulation) -> None:
    """Undoing a move of what is gone is refused in words and dropped; the step before is done."""
    async with page_of(server) as page:
        made = await page.ask("spawn", asset="cube", u=80, v=90)
        await page.ask("change_object", obj=made["id"], changes={"name": "box"})
        still.despawn_object("box")
        assert "box" in await page.refusal("undo")
        before = by_name(still)
        assert made["name"] in await page.refusal("undo")
        assert by_name(still) == before


@pytest.mark.slow
def test_buttons_and_keys_undo_in_a_browser(
    browser: Browser, server: ViewerServer, still: Simulation
) -> None:
    """A deleted object comes back where it was, and goes again; the buttons say what they do."""
    name = still.info.instances[0].name
    pose = still.get_object(name).pose
    opened = OpenPage(browser, server.url)
    opened.until(lambda: opened.frames, "a first frame")
    page = opened.page
    expect(page.locator("#undo")).to_be_disabled()
    opened.tab("Object")
    page.locator("#objects .row", has_text=name).first.click()
    expect(page.locator("#object-name")).to_have_value(name)
    page.click("#editor .danger")

    def there() -> bool:
        return name in {instance.name for instance in still.info.instances}

    opened.until(lambda: not there(), "the object to be deleted")
    expect(page.locator("#undo")).to_be_enabled()
    expect(page.locator("#undo")).to_have_attribute("title", f"Undo: deleting {name} (Z)")
    page.click("#undo")
    opened.until(there, "it to come back")
    np.testing.assert_allclose(still.get_object(name).pose.position_m, pose.position_m)
    expect(page.locator("#object-name")).to_have_value(name)
    page.locator("#stage").focus()
    page.keyboard.press("Shift+Z")
    opened.until(lambda: not there(), "it to be deleted again")
    page.keyboard.press("Control+Z")
    until(there, "it to come back by the key")
    opened.close()
