"""Figures that the paper measured, for comparison with ours.

E. Meloni, L. Pasqualini, M. Tiezzi, M. Gori, S. Melacci: SAILenv: Learning in Virtual Visual
Environments Made Simple, 2020, https://arxiv.org/abs/2007.08224. Numbers alone; knows nothing here.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

__all__ = ["DETECTION", "DETECTION_SOURCE", "FLOW_MS", "FLOW_SOURCE"]

FLOW_MS: Mapping[tuple[int, int], float] = MappingProxyType(
    {
        (240, 180): 40.0,
        (320, 240): 45.0,
        (640, 480): 70.0,
        (800, 600): 95.0,
        (1024, 768): 115.0,
        (1280, 960): 175.0,
    }
)
"""Mean time of a frame with flow [ms] by size of the picture, read off the curve in its figure."""

FLOW_SOURCE = (
    "The paper's SAILenv is read off the curve of its figure (arXiv:2007.08224, section V-B): "
    "Intel i9-9900K, NVIDIA GTX 1080, its own rooms on Unity."
)

DETECTION: Mapping[str, tuple[float, float, float, float]] = MappingProxyType(
    {
        "bed": (0.7830, 0.0879, 0.8201, 0.0894),
        "book": (0.3347, 0.2749, 0.3506, 0.2870),
        "chair": (0.6235, 0.0566, 0.5557, 0.4162),
        "couch": (0.8742, 0.0533, 0.9121, 0.0561),
        "dining table": (0.6891, 0.0398, 0.4553, 0.4096),
        "fork": (0.4599, 0.1274, 0.4800, 0.4294),
        "laptop": (0.9551, 0.0098, 0.9476, 0.0207),
        "airplane": (0.7193, 0.0314, 0.7865, 0.1005),
        "potted plant": (0.6106, 0.0499, 0.8894, 0.0656),
        "remote": (0.8980, 0.0400, 0.9534, 0.0127),
        "spoon": (0.4036, 0.1984, 0.3787, 0.3611),
        "tennis racket": (0.5120, 0.0475, 0.9548, 0.0127),
        "toilet": (0.9274, 0.0178, 0.9623, 0.0201),
        "tv": (0.9641, 0.0171, 0.9673, 0.0135),
    }
)
"""Mean and deviation of pixel IoU, then of box IoU, by class, in the table's order."""

DETECTION_SOURCE = (
    "The paper's figures are those of its table (arXiv:2007.08224, section V-A): Mask R-CNN with "
    "ResNet-50 on the paper's own objects, its views chosen by its authors."
)
