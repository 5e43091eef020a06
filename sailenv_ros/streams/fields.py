"""Types of fields of courses: numbers and counts of frames."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from sailenv_ros.scene.field_types import Number

__all__ = ["FrameCount", "FrameNumber"]

_MOST = 10**9
"""Beyond the end of every stream."""

FrameNumber: TypeAlias = Annotated[int, Number(least=0, most=_MOST, whole=True)]
FrameCount: TypeAlias = Annotated[int, Number(least=1, most=_MOST, whole=True)]
