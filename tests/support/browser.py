"""A real browser for tests: Debian's Chromium, driven by Playwright, without a window."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, expect, sync_playwright

from tests.support.waiting import until

DESKTOP = {"width": 1280, "height": 720}
PHONE = {"width": 400, "height": 800}

expect.set_options(timeout=40_000)


@contextlib.contextmanager
def chromium() -> Iterator[Browser]:
    """Start the browser; scripts/setup --dev installs it."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    assert program is not None, "these tests need Chromium: sudo apt-get install chromium"
    with sync_playwright() as driver:
        # Tests run as root in containers, where Chromium's sandbox cannot.
        browser = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        try:
            yield browser
        finally:
            browser.close()


class OpenPage:
    """The page in a tab of its own, with all that went wrong in it."""

    def __init__(self, browser: Browser, url: str, **settings: Any) -> None:
        self.context = browser.new_context(**{"viewport": DESKTOP, **settings})
        self.page: Page = self.context.new_page()
        self.faults: list[str] = []
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.on("console", self._said)
        self.page.goto(url)

    def _said(self, message: Any) -> None:
        if message.type in ("error", "warning"):
            self.faults.append(message.text)

    def close(self) -> None:
        """Close the tab; fail if anything went wrong in it."""
        self.context.close()
        assert not self.faults, self.faults

    def data(self, name: str) -> str:
        """Return what the page says of itself."""
        value: str = self.page.evaluate("name => document.body.dataset[name] ?? ''", name)
        return value

    @property
    def frames(self) -> int:
        """Number of the frame that is shown; 0 before the first."""
        return int(self.data("frame") or 0)

    def wait_for_frames(self, count: int = 2) -> None:
        """Wait until so many more frames are shown."""
        goal = self.frames + count
        self.until(lambda: self.frames >= goal, f"{count} more frames")

    def until(self, condition: Callable[[], object], what: str) -> None:
        """Wait for something, while the browser's events are heard."""

        def heard() -> object:
            self.page.wait_for_timeout(10)
            return condition()

        until(heard, what, 40.0)

    def picture(self, view: str) -> str:
        """Return a view's pixels, as a text to compare."""
        pixels: str = self.page.evaluate(
            "view => document.querySelector(`[data-view=${view}] .picture`).toDataURL()", view
        )
        return pixels

    def brightness(self, view: str) -> float:
        """Return the mean of a view's pixels, 0 to 255."""
        mean: float = self.page.evaluate(
            """view => {
                const canvas = document.querySelector(`[data-view=${view}] .picture`);
                const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
                copy.drawImage(canvas, 0, 0);
                const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
                const sum = data.reduce((all, value, at) => (at % 4 === 3 ? all : all + value), 0);
                return sum / (0.75 * data.length);
            }""",
            view,
        )
        return mean

    def tab(self, title: str) -> None:
        """Open a tab of the panel."""
        self.page.click(f"[data-tab={title}]")

    def at(self, u: float, v: float) -> tuple[float, float]:
        """Return where in the page a place of the large picture is, from (0, 0) to (1, 1)."""
        box = self.page.locator(".tile.main").bounding_box()
        assert box is not None
        return box["x"] + u * box["width"], box["y"] + v * box["height"]

    def download(self, selector: str, folder: Path) -> Path:
        """Click something that saves a file; return its path."""
        with self.page.expect_download() as waiting:
            self.page.click(selector)
        file = folder / waiting.value.suggested_filename
        waiting.value.save_as(file)
        return file
