"""Optical flow as others estimate it: two pictures in, displacement of each pixel out.

Farneback's and the dense inverse search of OpenCV, as they come; networks are in `flow_network`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2 as typed_cv2
import numpy as np
from numpy.typing import NDArray

__all__ = ["FlowMethod", "opencv_methods"]

# OpenCV's annotations lack functions of its own, and forbid None where its documentation has it.
cv2: Any = typed_cv2

Flow = NDArray[np.float32]
Picture = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlowMethod:
    """A way to estimate flow.

    Attributes
    ----------
    name : str
        A word, for files.
    label : str
        For people.
    compute : callable
        ``compute(first, second)`` takes two pictures (H, W, 3) uint8 BGR and gives (H, W, 2)
        float32: where each pixel of the first goes [px], u right, v down.
    """

    name: str
    label: str
    compute: Callable[[Picture, Picture], Flow]


def opencv_methods() -> tuple[FlowMethod, ...]:
    """Return Farneback's method and the dense inverse search at its three presets.

    Farneback's parameters are those of OpenCV's own example; turning pictures grey is part of every
    method's time.
    """
    presets = {
        "ultrafast": cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST,
        "fast": cv2.DISOPTICAL_FLOW_PRESET_FAST,
        "medium": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
    }
    searches = (
        FlowMethod(name=f"dis_{preset}", label=f"DIS {preset}", compute=_search(number))
        for preset, number in presets.items()
    )
    return (FlowMethod(name="farneback", label="Farneback", compute=_farneback), *searches)


def _farneback(first: Picture, second: Picture) -> Flow:
    flow = cv2.calcOpticalFlowFarneback(
        _grey(first), _grey(second), None, 0.5, 3, 15, 3, 5, 1.2, 0
    )  # fmt: skip
    return np.asarray(flow, np.float32)


def _search(preset: int) -> Callable[[Picture, Picture], Flow]:
    search = cv2.DISOpticalFlow_create(preset)

    def compute(first: Picture, second: Picture) -> Flow:
        return np.asarray(search.calc(_grey(first), _grey(second), None), np.float32)

    return compute


def _grey(bgr: Picture) -> Any:
    return cv2.cvtColor(bgr, cv2.COLOR_BGR2GRAY)
