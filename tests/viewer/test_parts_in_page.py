"""The page and parts of a model: a click on a pillow selects the bed."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import expect

from sailenv_ros.simulation import Simulation
from tests.support.browser import OpenPage
from tests.support.divided_bed import LEFT, RIGHT, write_bed_pack
from tests.support.waiting import until

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def simulation(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Simulation]:
    """A simulation whose catalogue has a bed with two pillows."""
    folder = tmp_path_factory.mktemp("pack")
    write_bed_pack(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SAILENV_PACKS", str(folder))
        with Simulation("optical") as simulation:
            yield simulation


def test_a_part_is_listed_and_selects_its_body(simulation: Simulation, opened: OpenPage) -> None:
    """Parts stand in the list; who chooses one edits the body, and deletes both."""
    body = simulation.spawn_object("test_bed", position=(3.0, 0.0, 0.0), object_name="cot")
    parts = {one.name: one.id for one in simulation.info.instances if one.parent == body}
    assert set(parts) == {f"cot/{LEFT}", f"cot/{RIGHT}"}
    opened.tab("Object")
    row = opened.page.locator(f"#objects [data-id='{parts[f'cot/{LEFT}']}']")
    expect(row).to_contain_text("part")
    row.click()
    opened.until(lambda: opened.data("selected") == str(body), "the body to be selected")
    opened.page.locator("#stage").focus()
    opened.page.keyboard.press("Delete")
    gone = {body, *parts.values()}
    until(lambda: not gone & {one.id for one in simulation.info.instances}, "all to be gone")
