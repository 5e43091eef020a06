"""The page and look-at constraints: a list shows what the agent faces, and changes it."""

from __future__ import annotations

import math

import pytest
from playwright.sync_api import Locator, expect

from sailenv_ros.simulation import Simulation
from sailenv_ros.types.look_at import LookAt
from tests.support.browser import OpenPage
from tests.support.waiting import until

pytestmark = pytest.mark.slow

SCENE = """
version: 1
objects:
  - {name: ball, asset: sphere, position: [0, 3, 1], gravity: false}
  - {name: post, asset: cube, position: [3, 0, 1], static: true}
movers:
  - {name: cart, position: [0, 0, 1], controller: rigidbody}
  - {name: puck, position: [0, -3, 1], body: {gravity: false}}
agents:
  - {name: rider, width: 64, height: 48, mover: puck, keep_looking_at: {object: post}}
"""

EYE = "debug_agent"


def heading(simulation: Simulation) -> float:
    return simulation.get_pose(agent=EYE).rpy_deg[2]


def chosen(select: Locator) -> str:
    return str(select.evaluate("list => list.selectedOptions[0].textContent"))


def test_a_choice_turns_the_agent_and_a_drag_ends_it(
    opened: OpenPage, simulation: Simulation
) -> None:
    """What a program sets is shown, too: a point that the list does not have, an object."""
    select = opened.page.locator("#look-at")
    expect(select).to_be_enabled()
    assert select.locator("option").all_text_contents() == ["nothing", "ball", "post"]
    select.select_option(label="ball")
    opened.until(lambda: simulation.get_look_at(agent=EYE) == LookAt(obj="ball"), "the ball")
    assert heading(simulation) == pytest.approx(90.0, abs=1e-6)
    simulation.set_look_at(point_m=(-1.0, 0.0, 1.25), agent=EYE)
    opened.until(lambda: chosen(select) == "(-1, 0, 1.25)", "the point")
    simulation.set_look_at("post", agent=EYE)
    opened.until(lambda: chosen(select) == "post", "the post")
    assert select.locator("option").count() == 3
    select.select_option(label="ball")
    opened.until(lambda: heading(simulation) == pytest.approx(90.0, abs=1e-6), "the turn")
    mouse = opened.page.mouse
    mouse.move(*opened.at(0.5, 0.5))
    mouse.down()
    mouse.move(*opened.at(0.7, 0.5), steps=4)
    mouse.up()
    opened.until(lambda: simulation.get_look_at(agent=EYE) is None, "the end")
    opened.until(lambda: chosen(select) == "nothing", "the list to tell")
    assert math.isfinite(heading(simulation))


def test_each_agent_has_its_own(opened: OpenPage, simulation: Simulation) -> None:
    """That of the scene faces the post; nothing is chosen for it; its mover is not driven."""
    page = opened.page
    select = page.locator("#look-at")
    page.locator("#agent").select_option(label="rider")
    opened.until(lambda: chosen(select) == "post", "the post")
    expect(page.locator("#controller")).to_have_text("Forces drive")
    select.select_option(label="nothing")
    until(lambda: simulation.get_look_at(agent="rider") is None, "nothing")
    page.locator("#stage").focus()
    page.keyboard.down("w")
    expect(page.locator(".toast").first).to_contain_text("body")
    page.keyboard.up("w")
    assert simulation.get_mover_velocity("puck") == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    page.locator("#agent").select_option(label=EYE)
    opened.until(lambda: chosen(select) == "nothing", "its own")
