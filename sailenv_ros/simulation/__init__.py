"""The composition root without ROS: scene, world and renderer behind one thread-safe face.

Its names are imported when they are first used: operations and models have no need of them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sailenv_ros.simulation.frame_stream import FrameStream
    from sailenv_ros.simulation.simulation import Simulation

__all__ = ["FrameStream", "Simulation"]

_HOMES = {"FrameStream": "frame_stream", "Simulation": "simulation"}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
