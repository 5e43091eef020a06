"""A reader of USD's text as far as our own writer writes it: prims by path, attributes by name."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

PRIM = re.compile(r'(def|class) (\w+) "(\w+)"')
ATTRIBUTE = re.compile(r"(?:custom |uniform )*([\w\[\]]+) ([\w:.]+)(?: = (.+))?")


@dataclass
class Prim:
    """One prim: its type, metadata, attributes and relationships as they are written."""

    kind: str
    path: str
    metadata: dict[str, str] = field(default_factory=dict)
    values: dict[str, str] = field(default_factory=dict)

    def numbers(self, name: str) -> NDArray[np.float64]:
        """All numbers of an attribute, flat."""
        return np.array(re.findall(r"[-+.\deE]+", self.values[name]), np.float64)

    def targets(self, name: str) -> list[str]:
        return re.findall(r"<([^>]+)>", self.values[name])

    def pose(self) -> NDArray[np.float64]:
        """(4, 4) parent_from_prim."""
        assert self.values["xformOpOrder"].startswith('["xformOp:translate", "xformOp:orient"')
        w, x, y, z = self.numbers("xformOp:orient")
        matrix = np.eye(4)
        matrix[:3, :3] = Rotation.from_quat((x, y, z, w)).as_matrix()
        matrix[:3, 3] = self.numbers("xformOp:translate")
        return matrix


def read_usda(data: bytes) -> tuple[dict[str, str], dict[str, Prim]]:
    """Return the layer's metadata, and all prims by their paths."""
    layer: dict[str, str] = {}
    prims: dict[str, Prim] = {}
    above: list[Prim] = []
    where = layer
    lines = iter(data.decode("utf-8").splitlines())
    assert next(lines) == "#usda 1.0"
    for raw in lines:
        line = raw.strip()
        begun = PRIM.match(line)
        if begun:
            path = f"{above[-1].path if above else ''}/{begun[3]}"
            assert path not in prims, path
            prims[path] = Prim(kind=begun[2], path=path)
            where = prims[path].metadata
            pending = prims[path]
        elif line == "{":
            above.append(pending)
            where = pending.values
        elif line == "}":
            above.pop()
            where = above[-1].values if above else {}
        elif line in ("", "(", ")"):
            continue
        else:
            _take(line, where)
    assert not above
    return layer, prims


def _take(line: str, where: dict[str, str]) -> None:
    named = re.match(r"(?:rel )?([\w: ]+?) = (.+)", line)
    found = ATTRIBUTE.fullmatch(line.removesuffix(" ("))
    if line.startswith("rel ") or found is None:
        assert named is not None, line
        where[named[1]] = named[2]
    elif found[2] != "=":
        where[found[2]] = found[3] or ""


def frame(prim: Prim, number: int) -> NDArray[Any]:
    """(4, 4) frame of a joint in its body 0 or 1."""
    w, x, y, z = prim.numbers(f"physics:localRot{number}")
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_quat((x, y, z, w)).as_matrix()
    matrix[:3, 3] = prim.numbers(f"physics:localPos{number}")
    return matrix
