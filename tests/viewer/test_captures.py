"""Data sets that a page captures while somebody walks: over the socket, and in a browser."""

from __future__ import annotations

import asyncio
import io
import json
import urllib.error
import urllib.request
import zipfile
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import expect

from sailenv_ros.dataset.live_capture import LiveCapture
from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer import ViewerServer
from sailenv_ros.viewer.viewer_limits import ViewerLimits
from tests.support.browser import OpenPage
from tests.support.viewer_socket import ViewerSocket, connected, in_a_loop, page_of
from tests.viewer.conftest import SMALL


@pytest.fixture(scope="module")
def server(simulation: Simulation) -> Iterator[ViewerServer]:
    """A viewer that offers data sets."""
    with ViewerServer(simulation, port=0, data_sets=LiveCapture()) as server:
        server.set_intrinsics(SMALL)
        yield server


def _downloaded(server: ViewerServer, key: str) -> zipfile.ZipFile:
    address = f"http://127.0.0.1:{server.port}/captured/{key}"
    with urllib.request.urlopen(address, timeout=60.0) as got:
        return zipfile.ZipFile(io.BytesIO(got.read()))


def _wish(**changes: Any) -> dict[str, Any]:
    return {"agent": "debug_agent", "frames": 3, "rate_hz": 30.0, **changes}


async def _capturing(page: ViewerSocket) -> str:
    """Return the next news of how far a capture is."""
    return str((await page.until(lambda message: message["type"] == "stats"))["capturing"])


@in_a_loop
async def test_frames_of_time_as_it_goes_on_are_captured(server: ViewerServer) -> None:
    async with page_of(server) as page:
        made = await page.ask("capture_data_set", **_wish(format_name="coco"))
        assert (made["name"], made["frames"]) == ("optical_coco.zip", 3)
        with await asyncio.to_thread(_downloaded, server, made["key"]) as archive:
            notes = json.loads(archive.read("optical_coco/annotations.json"))
            names = archive.namelist()
        assert len(notes["images"]) == 3
        assert sum("/images/" in name for name in names) == 3
        await page.ask("capture_data_set", **_wish(format_name="png", frames=1))
        with pytest.raises(urllib.error.HTTPError, match="404"):  # the last one alone is kept
            await asyncio.to_thread(_downloaded, server, made["key"])


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"format_name": "cocoo"}, "did you mean 'coco'"),
        (
            {"format_name": "png", "agent": "nobody"},
            "debug_agent, got 'nobody'",
        ),
        ({"format_name": "png", "frames": 0}, "frames must be"),
        ({"format_name": "png", "frames": 10_000}, "frames must be"),
        ({"format_name": "png", "rate_hz": 0.0}, "rate_hz must be"),
    ],
)
@in_a_loop
async def test_what_cannot_be_captured_is_told(
    server: ViewerServer, changes: dict[str, Any], told: str
) -> None:
    async with page_of(server) as page:
        assert told in await page.refusal("capture_data_set", **_wish(**changes))


@in_a_loop
async def test_one_at_a_time_and_stopped_by_anybody(server: ViewerServer) -> None:
    """What was seen until then is in the file."""
    async with page_of(server) as page, page_of(server) as other:
        wish = _wish(format_name="png", frames=300, rate_hz=1.0)
        await page.socket.send_json({"do": "capture_data_set", "id": 99, **wish})
        while " of 300 frames as png" not in await _capturing(other):
            pass
        told = await other.refusal("capture_data_set", **wish)
        assert "another data set is being captured" in told
        await other.ask("stop_capture")
        made = await page.until(lambda message: message.get("id") == 99)
        assert 1 <= made["result"]["frames"] < 300


@in_a_loop
async def test_a_paused_scene_gives_one_frame(server: ViewerServer, simulation: Simulation) -> None:
    async with page_of(server) as page:
        await page.ask("pause")
        try:
            made = await page.ask("capture_data_set", **_wish(format_name="png", frames=1))
            assert made["frames"] == 1
            told = await page.refusal("capture_data_set", **_wish(format_name="png", frames=2))
            assert "time stands still" in told
        finally:
            await page.ask("resume")


@in_a_loop
async def test_whoever_goes_away_leaves_nothing(server: ViewerServer) -> None:
    async with page_of(server) as page:
        made = await page.ask("capture_data_set", **_wish(format_name="png", frames=1))
        async with page_of(server) as other:
            wish = _wish(format_name="kitti", frames=300)
            await other.socket.send_json({"do": "capture_data_set", "id": 99, **wish})
            while "of 300 frames as kitti" not in await _capturing(page):
                pass
        while await _capturing(page):
            pass
        with await asyncio.to_thread(_downloaded, server, made["key"]) as archive:
            assert "optical_png/frames.json" in archive.namelist()


def test_a_data_set_that_grows_too_large_is_refused(simulation: Simulation) -> None:
    @in_a_loop
    async def look(server: ViewerServer) -> None:
        async with page_of(server) as page:
            told = await page.refusal("capture_data_set", **_wish(format_name="png"))
            assert "grows beyond 0.01 MB" in told

    limits = ViewerLimits(capture_bytes=10_000)
    with ViewerServer(simulation, port=0, limits=limits, data_sets=LiveCapture()) as server:
        look(server)


def test_without_a_maker_nothing_is_offered(simulation: Simulation) -> None:
    @in_a_loop
    async def look(server: ViewerServer) -> None:
        async with connected(server) as page:
            hello = await page.read()
            assert hello["data_sets"] == []
            told = await page.refusal("capture_data_set", **_wish(format_name="png"))
            assert "format must be" in told

    with ViewerServer(simulation, port=0) as server:
        look(server)


@pytest.mark.slow
def test_the_page_saves_it(opened: OpenPage) -> None:
    opened.tab("Scene")
    page = opened.page
    page.select_option("#capture-format", "nerfstudio")
    page.fill("#capture-frames", "3")
    page.fill("#capture-rate", "10")
    with page.expect_download() as coming:
        page.click("button.capture")
    assert coming.value.suggested_filename == "optical_nerfstudio.zip"
    with zipfile.ZipFile(coming.value.path()) as archive:
        table = json.loads(archive.read("optical_nerfstudio/transforms.json"))
    assert len(table["frames"]) == 3
    expect(page.locator("#captured")).to_contain_text("3 frames, ")
    page.fill("#capture-frames", "301")
    page.click("button.capture")
    expect(page.locator("#captured")).to_contain_text("frames")
