"""The page and joints: a slider opens a door, and undo shuts it."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from sailenv_ros.simulation import Simulation
from tests.support.browser import OpenPage
from tests.support.plain_doors import SCENE as DOORS
from tests.support.waiting import until

pytestmark = pytest.mark.slow

SCENE = DOORS + "\nroom: {size: [8, 8, 2.5], openings: [{type: door, wall: east, hinged: true}]}\n"


@pytest.mark.parametrize("name", ["door", "door 1 leaf"])
def test_a_slider_opens_a_door_and_undo_shuts_it(
    simulation: Simulation, opened: OpenPage, name: str
) -> None:
    """That of a cabinet and that of a room; what has no joint has no slider."""
    ids = {one.name: one.id for one in simulation.info.instances}

    def position() -> float:
        return next(j.position for j in simulation.get_joints() if j.name == name)

    opened.tab("Object")
    opened.page.locator(f"#objects [data-id='{ids[name]}']").click()
    slider = opened.page.locator("#joint input")
    expect(slider).to_be_visible()
    slider.fill("0.9")
    until(lambda: abs(position() - 0.9) < 0.02, "the door to open")
    opened.page.locator("#stage").focus()
    opened.page.keyboard.press("Control+z")
    until(lambda: position() == 0.0, "the door to be shut")
    opened.page.locator(f"#objects [data-id='{ids['cabinet']}']").click()
    expect(opened.page.locator("#object-name")).to_have_value("cabinet")
    expect(slider).to_have_count(0)
