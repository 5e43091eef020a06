"""The page of a data set in a real browser: filters, views, overlays, one frame at large."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sailenv_ros.dataset import engine_of, load_job, make_dataset
from sailenv_ros.dataset.preview_page import save_preview
from tests.support.browser import OpenPage, chromium
from tests.unit.dataset.conftest import SMALL, written_recipe

HOSTILE = "</script><script>document.title = 'owned'</script><img src=x onerror=alert(1)>"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OpenPage]:
    """The page of a small data set whose texts would like to be code."""
    folder = tmp_path_factory.mktemp("page")
    recipe = written_recipe(
        folder,
        cameras=SMALL["cameras"][:1],
        formats=["webdataset"],
        clips={"train": 3, "val": 1},
        description=HOSTILE,
    )
    make_dataset(load_job(recipe), folder / "set", engine_of(1, None))
    assert save_preview(folder / "set", folder / "set.html") == 12
    with chromium() as browser:
        opened = OpenPage(browser, (folder / "set.html").as_uri())
        yield opened
        opened.close()


def test_frames_are_shown_with_masks_boxes_and_names(page: OpenPage) -> None:
    assert page.data("shown") == "12"
    tile = page.page.locator(".tile").first
    assert tile.locator(".object .outline").count() >= 2
    thing, room = (tile.locator(f".object{kind} .box").first for kind in (":not(.room)", ".room"))
    assert thing.is_visible()
    assert not room.is_visible()
    page.page.check("#room")
    assert room.is_visible()
    page.page.uncheck("#boxes")
    assert not thing.is_visible()
    page.page.check("#boxes")
    page.page.uncheck("#room")
    widths = page.page.evaluate("[...document.images].map(one => one.naturalWidth)")
    assert all(widths)


def test_filters_by_split_and_category(page: OpenPage) -> None:
    page.page.click("[data-key=split][data-value=val]")
    assert page.data("shown") == "3"
    page.page.click("[data-key=category]:nth-child(1)")
    assert page.data("shown") == "3"
    page.page.click("[data-key=category]:nth-child(1)")
    page.page.click("[data-key=split][data-value=val]")
    assert page.data("shown") == "12"


def test_every_view_can_be_shown(page: OpenPage) -> None:
    sources = set()
    for view in SMALL["views"]:
        page.page.click(f"[data-key=view][data-value={view}]")
        sources.add(page.page.locator(".tile img").first.get_attribute("src"))
    assert len(sources) == len(SMALL["views"])


def test_a_frame_at_large_tells_of_its_objects(page: OpenPage) -> None:
    page.page.locator(".tile").nth(0).click()
    assert page.data("open") == "0"
    row = page.page.locator("#large-right tbody tr").first
    row.hover()
    assert page.page.locator("#large .object.chosen").count() == 1
    page.page.keyboard.press("ArrowRight")
    assert page.data("open") == "1"
    page.page.keyboard.press("Escape")
    page.until(lambda: page.data("open") == "", "the frame to close")


def test_texts_of_a_data_set_are_no_code(page: OpenPage) -> None:
    assert page.page.title() == "small – data set"
    assert HOSTILE in page.page.locator("header").inner_text()
    assert page.page.locator("img[src=x]").count() == 0
