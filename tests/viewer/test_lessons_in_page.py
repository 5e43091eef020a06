"""The page and lessons: it tells which one it is, begins them and stops them."""

from __future__ import annotations

import pytest

from sailenv_ros.simulation import Simulation
from tests.support.browser import OpenPage
from tests.support.waiting import until

pytestmark = pytest.mark.slow

SCENE = """
version: 1
objects:
  - {name: one, asset: cube, position: [1, 0, 1], gravity: false}
  - {name: two, asset: sphere, position: [1, 0, 1], gravity: false}
mover: {position: [-1.8, 0, 1.4]}
lessons: {sequence: [{objects: [one], duration: 1000}, {objects: [two], duration: 1000}]}
"""


def test_lessons_are_told_stopped_and_begun(simulation: Simulation, opened: OpenPage) -> None:
    page = opened.page
    page.get_by_role("tab", name="Scene").click()
    told = page.locator("#lesson")
    until(lambda: told.inner_text() == "lap 1, lesson 1 of 2: one", "the lesson")
    page.locator("button.stop-lessons").click()
    until(lambda: told.inner_text().endswith("one (stopped)"), "the end")
    assert simulation.lesson is not None
    assert simulation.lesson.phase == "stopped"
    page.locator("button.start-lessons").click()
    until(lambda: told.inner_text() == "lap 1, lesson 1 of 2: one", "a new beginning")
