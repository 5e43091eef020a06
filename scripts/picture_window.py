"""Picture the web viewer: room_02 as it runs, the pointer upon a cushion.

    PYTHONPATH=. python scripts/picture_window.py FILE

Called by scripts/docs-images; needs what the tests of the page need.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer import ViewerServer
from tests.support.browser import OpenPage, chromium

SCENE, CUSHION = "room_02", "ochre cushion"

STEPS = 1920
"""To where the camera begins to see most of the living room."""

FRAMES = 10
"""Shown before the picture is taken, so that the rate that the page measures has settled."""


def main(path: Path) -> None:
    """Write the picture."""
    with (
        Simulation(SCENE, paused=True) as simulation,
        ViewerServer(simulation, port=0) as server,
        chromium() as browser,
    ):
        simulation.step(STEPS)
        opened = OpenPage(browser, server.url)
        try:
            simulation.resume()
            opened.wait_for_frames(FRAMES)
            # The camera turns so slowly that it is still there when the picture is taken.
            opened.page.mouse.move(*opened.at(*_middle(simulation, CUSHION)))
            opened.until(lambda: CUSHION in opened.page.inner_text("body"), "the cushion's name")
            opened.page.screenshot(path=path, type="jpeg", quality=88)
        finally:
            opened.close()
    print(path)


def _middle(simulation: Simulation, name: str) -> tuple[float, float]:
    """Return where an object is in the web viewer's large picture, from (0, 0) to (1, 1)."""
    instance = simulation.capture(["instance"], agent="debug_agent").views["instance"]
    rows, columns = np.nonzero(instance == simulation.get_object(name).id)
    height, width = instance.shape
    return float(np.median(columns)) / width, float(np.median(rows)) / height


if __name__ == "__main__":
    main(Path(sys.argv[1]))
