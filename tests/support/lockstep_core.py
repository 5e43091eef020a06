"""A simulation in lockstep, without a thread of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from tests.support.blank_renderer import BlankRenderer


def lockstep_core(
    scene: str | Path = "optical", *paths: Path, **settings: Any
) -> SynchronousSimulation:
    """Return one that draws nothing, unless `settings` name another renderer.

    `paths` are folders of scene files beside the package's.
    """
    return SynchronousSimulation(
        SceneLibrary(paths), scene, **{"renderer": BlankRenderer(), **settings}
    )
