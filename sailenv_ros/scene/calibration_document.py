"""A calibrator's file while it is read: its parts with their types, faults with their place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, SceneDiagnostic, SceneError
from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.yaml_nodes import Loc, Mark, Node
from sailenv_ros.types.camera import INTRINSICS_LIMITS, CameraIntrinsics
from sailenv_ros.types.validation import is_finite_number

__all__ = ["SIZE", "CalibrationDocument"]

SIZE = INTRINSICS_LIMITS["width"]
"""Bounds of a side of a picture [px]."""

ROTATION_TOLERANCE = 1e-3
"""By how much numbers of a written rotation may miss those of the nearest one."""


@dataclass
class CalibrationDocument:
    """A file, and the place of its parts."""

    path: Path
    node: Node = field(default_factory=lambda: Node(Mark(1, 1), {}))

    def refuse(self, mark: Mark, message: str, name: str = "") -> NoReturn:
        """Raise the error of a place."""
        raise SceneError(
            [
                SceneDiagnostic(
                    path=str(self.path),
                    line=mark.line,
                    column=mark.column,
                    field=name,
                    message=message,
                )
            ]
        )

    def at(self, *loc: str | int) -> Node:
        """Return a part that must be there."""
        found: Node | None = self.node
        for depth, part in enumerate(loc):
            inner = None if found is None else found.child(part)
            if inner is None:
                self.refuse(self.node.place(loc[:depth]), "is missing", _dotted(loc))
            found = inner
        assert found is not None
        return found

    def numbers(self, loc: Loc, accepted: str, counts: Sequence[int] = ()) -> list[float]:
        """Return a list of finite numbers."""
        node = self.at(*loc)
        values = node.plain()
        fits = isinstance(values, list) and all(map(is_finite_number, values))
        if not fits or (counts and len(values) not in counts):
            self.refuse(node.mark, f"must be {accepted}, got {shown(values)}", _dotted(loc))
        return [float(value) for value in values]

    def rigid(self, loc: Loc) -> NDArray[np.float64]:
        """Return (4, 4) float64: a rigid transform, whose rotation is made exact."""
        rows = [self.numbers((*loc, row), "four numbers", (4,)) for row in range(4)]
        matrix = np.array(rows)
        u, _, vt = np.linalg.svd(matrix[:3, :3])
        rotation = u @ vt
        if (
            np.abs(rotation - matrix[:3, :3]).max() > ROTATION_TOLERANCE
            or np.linalg.det(rotation) < 0.0
            or rows[3] != [0.0, 0.0, 0.0, 1.0]
        ):
            accepted = "four rows of a rotation and a translation, the last one 0, 0, 0, 1"
            self.refuse(self.at(*loc).mark, f"must be {accepted}", _dotted(loc))
        matrix[:3, :3] = rotation
        return matrix

    def size(self, loc: Loc) -> int:
        """Return a width or a height."""
        node = self.at(*loc)
        accepted = SIZE.refused(node.value)
        if accepted:
            self.refuse(node.mark, f"must be {accepted}, got {shown(node.plain())}", _dotted(loc))
        return int(node.value)

    def word(self, loc: Loc, known: Sequence[str]) -> str:
        """Return a text that is one of those known."""
        node = self.at(*loc)
        if node.value not in known:
            accepted = f"must be one of: {', '.join(known)}; got {shown(node.plain())}"
            self.refuse(node.mark, accepted, _dotted(loc))
        return str(node.value)

    def lens(
        self, mark: Mark, size: Sequence[int], matrix: Mapping[str, float], others: dict[str, Any]
    ) -> CameraIntrinsics:
        """Return what the numbers make, or refuse it at a place."""
        width, height = size
        if not (matrix["fx"] > 0.0 and matrix["fy"] > 0.0):
            got = f"{matrix['fx']:g} and {matrix['fy']:g}"
            self.refuse(mark, f"makes no lens: focal lengths must be above 0 [px], got {got}")
        try:
            return CameraIntrinsics(
                width=width,
                height=height,
                fx_px=matrix["fx"],
                fy_px=matrix["fy"],
                cx_offset_px=matrix["cx"] - 0.5 * (width - 1),
                cy_offset_px=matrix["cy"] - 0.5 * (height - 1),
                **others,
            )
        except InvalidRequest as problem:
            self.refuse(mark, f"makes no lens: {problem}")


def _dotted(loc: Loc) -> str:
    return ".".join(map(str, loc))
