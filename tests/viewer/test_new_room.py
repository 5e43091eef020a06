"""A room from a seed in the editor: made, made again, kept."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from sailenv_ros.authoring.room_rules.rule_files import room_kinds
from sailenv_ros.cli.main import main
from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer import ViewerServer
from tests.support.browser import OpenPage
from tests.support.viewer_socket import in_a_loop, page_of
from tests.support.waiting import until


@in_a_loop
async def test_kinds_are_listed_and_a_room_is_begun(
    server: ViewerServer, simulation: Simulation
) -> None:
    simulation.change_scene("optical")
    async with page_of(server) as page:
        kinds = await page.ask("room_kinds")
        assert [entry["kind"] for entry in kinds] == list(room_kinds())
        made = await page.ask("generate_room", kind="bathroom", seed=2)
        assert made == {"scene": "generated:bathroom:2"}
        assert simulation.info.scene == "generated_bathroom_2"
        for kind, seed, told in (
            ("bathrom", 2, "did you mean 'bathroom'"),
            ("bathroom", -1, "seed must be"),
        ):
            with pytest.raises(Exception, match=told):
                await page.ask("generate_room", kind=kind, seed=seed)
        assert simulation.info.scene == "generated_bathroom_2"


@pytest.mark.slow
def test_a_room_is_made_and_kept_in_a_browser(
    opened: OpenPage, simulation: Simulation, own_scenes: Path
) -> None:
    page = opened.page
    opened.tab("Scene")
    page.select_option("#room-kind", "bathroom")
    page.fill("#room-seed", "3")
    page.click("button.make-room")
    until(lambda: simulation.info.scene == "generated_bathroom_3", "the room")
    expect(page.locator("#room-made")).to_contain_text("generated:bathroom:3")
    page.click("button.again-room")
    until(lambda: simulation.info.scene == "generated_bathroom_4", "the next room")
    opened.until(lambda: page.input_value("#room-seed") == "4", "the next seed")
    expect(page.locator("#room-made")).to_contain_text("generated:bathroom:4")
    page.click("button.keep-room")
    file = own_scenes / "bathroom_4.yaml"
    until(file.is_file, "the file")
    assert main(["scene", "check", "--physics", str(file)]) == 0
