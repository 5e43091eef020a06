"""The page and its connection: it says that the simulator is away, and goes on when it is back."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer import ViewerServer
from tests.support.browser import OpenPage, chromium

pytestmark = pytest.mark.slow


def test_the_page_goes_on_after_the_simulator_was_away(simulation: Simulation) -> None:
    """With the views, the agent and the object that were chosen."""
    number = simulation.info.instances[1].id
    with chromium() as browser:
        with ViewerServer(simulation, port=0) as server:
            port = server.port
            opened = OpenPage(browser, server.url)
            page = opened.page
            opened.wait_for_frames()
            page.uncheck("[data-shows=flow]")
            opened.tab("Object")
            page.click(f"#objects [data-id='{number}']")
            expect(page.locator("#object-name")).to_be_visible()
        expect(page.locator("#offline")).to_be_visible()
        last = opened.frames
        with ViewerServer(simulation, port=port):
            expect(page.locator("#offline")).to_be_hidden()
            opened.until(lambda: opened.frames != last, "frames of the new server")
            opened.wait_for_frames()
            expect(page.locator(".tile:visible")).to_have_count(4)
            assert opened.data("selected") == str(number)
            simulation.change_object(number, name="renamed meanwhile")
            expect(page.locator("#object-name")).to_have_value("renamed meanwhile")
            opened.faults.clear()  # the browser tells that it could not connect
            opened.close()
