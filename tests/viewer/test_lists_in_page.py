"""Lists of the page while they change: what is pressed there stays, and no click is lost."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, expect

from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer.scene_json import skies_to_json
from tests.support.browser import OpenPage
from tests.support.waiting import until

pytestmark = pytest.mark.slow


def press(opened: OpenPage, target: Locator) -> None:
    """Press the mouse on the middle of an element, and hold it."""
    target.scroll_into_view_if_needed()
    box = target.bounding_box()
    assert box is not None
    opened.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    opened.page.mouse.down()


def lights(simulation: Simulation) -> list[str]:
    return [light.name for light in simulation.info.lights]


def test_two_quick_clicks_add_two_lights(opened: OpenPage, simulation: Simulation) -> None:
    """The second one comes before the page knows of the first light."""
    own = lights(simulation)
    opened.tab("Light")
    opened.page.get_by_text("Add a light").click()
    opened.page.locator(".add-light").click(click_count=2)
    until(lambda: lights(simulation) == [*own, "point 1", "point 2"], "two lights")
    expect(opened.page.locator("[data-light]")).to_have_count(len(own) + 2)
    expect(opened.page.locator(".toast.error")).to_have_count(0)


def test_a_light_is_added_though_the_list_grows_meanwhile(
    opened: OpenPage, simulation: Simulation
) -> None:
    """The button stays under the pointer that presses it."""
    own = lights(simulation)
    opened.tab("Light")
    opened.page.get_by_text("Add a light").click()
    press(opened, opened.page.locator(".add-light"))
    simulation.add_light("of a program", "point")
    expect(opened.page.locator("[data-light='of a program']")).to_be_visible()
    opened.page.mouse.up()
    until(lambda: lights(simulation) == [*own, "of a program", "point 1"], "the light")


def test_a_row_is_clicked_though_its_list_changes_meanwhile(
    opened: OpenPage, simulation: Simulation
) -> None:
    """Of objects, of waypoints and of lights: others come and go while one is pressed."""
    page = opened.page
    number = simulation.info.instances[1].id
    opened.tab("Object")
    press(opened, page.locator(f"#objects [data-id='{number}']"))
    made = simulation.spawn_object("cube", position=(0.0, 0.0, 3.0))
    expect(page.locator(f"#objects [data-id='{made}']")).to_have_count(1)
    page.mouse.up()
    opened.until(lambda: opened.data("selected") == str(number), "the selection")
    opened.tab("Light")
    press(opened, page.get_by_title("Remove sun", exact=True))
    simulation.add_light("lamp", "point")
    expect(page.locator("[data-light=lamp]")).to_be_visible()
    page.mouse.up()
    until(lambda: "sun" not in lights(simulation), "the sun to be taken down")
    opened.tab("Path")
    before = len(simulation.info.movers[0].waypoints)
    press(opened, page.get_by_title("Remove waypoint 1", exact=True))
    simulation.set_waypoints([simulation.get_mover_pose()], append=True)
    expect(page.locator("#waypoints li")).to_have_count(before + 1)
    page.mouse.up()
    until(lambda: len(simulation.info.movers[0].waypoints) == before, "the waypoint to go")


def test_a_row_of_the_legend_is_clicked_though_frames_come(
    opened: OpenPage, simulation: Simulation
) -> None:
    """The legend is written anew some times a second."""
    page = opened.page
    stage = page.locator("#stages .share").first
    expect(stage).to_contain_text("ms")
    press(opened, page.locator("#legend .row").first)
    before = page.locator("#camera").inner_text()
    opened.until(lambda: page.locator("#camera").inner_text() != before, "the panel to go on")
    page.mouse.up()
    opened.until(lambda: opened.data("selected") not in ("", "0"), "the selection")


def test_the_page_follows_an_object_that_a_program_moves(
    opened: OpenPage, simulation: Simulation
) -> None:
    """Its numbers are those of the simulation, without a question of the page."""
    simulation.pause()
    number = simulation.spawn_object("cube", position=(0.0, 0.0, 1.0))
    opened.tab("Object")
    opened.page.locator(f"#objects [data-id='{number}']").click()
    expect(opened.page.locator("#position-x")).to_have_value("0.000")
    simulation.move_object(number, position=(1.25, 0.0, 1.0), teleport=True)
    expect(opened.page.locator("#position-x")).to_have_value("1.250")
    simulation.resume()


def test_plain_colours_take_the_place_of_a_sky(opened: OpenPage, simulation: Simulation) -> None:
    """Whatever sky the machine has: the list leads back to none."""
    sky = skies_to_json()[0]
    opened.tab("Light")
    opened.page.select_option("#sky", sky)
    until(lambda: simulation.info.environment.sky_map == sky, "the sky")
    opened.page.select_option("#sky", label="plain colours")
    until(lambda: simulation.info.environment.sky_map == "", "plain colours")
    expect(opened.page.locator(".toast.error")).to_have_count(0)
