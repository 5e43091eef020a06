"""The materials that OBJ files without a material library name: `config/wavefront_colours.yaml`."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any

from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.yaml_text import from_yaml

__all__ = ["material_file", "with_glass"]

GLASS = "sailenv_glass"
PANE = re.compile(rb"^[go]\s+.*sweethome3d_window_pane")
WHITEST = 0.85
"""No paint is whiter."""


@lru_cache(maxsize=1)
def material_file() -> str:
    """Return a Wavefront material library with all of them."""
    path = resource_path("config", "wavefront_colours.yaml")
    data: Any = from_yaml(path.read_text(encoding="utf-8"))
    lines = [f"newmtl {GLASS}", "Kd 0.9 0.95 0.95", "Ks 0.5 0.5 0.5", "Ns 400", "d 0.08"]
    for name, values in data["materials"].items():
        *colour, specular, exponent = values[:5]
        red, green, blue = (min(part, WHITEST) for part in colour)
        opacity = values[5:]
        lines += [f"newmtl {name}", f"Kd {red} {green} {blue}"]
        lines += [f"Ks {specular} {specular} {specular}", f"Ns {exponent}"]
        lines += [f"d {opacity[0]}"] if opacity else []
    return "\n".join(lines) + "\n"


def with_glass(obj: bytes) -> bytes:
    """Return an OBJ file whose window panes, which the program knows by their names, are glass."""
    lines, pane = [], False
    for line in obj.splitlines():
        if line[:2] in (b"g ", b"o "):
            pane = PANE.match(line) is not None
            lines.append(line)
            lines += [b"usemtl " + GLASS.encode()] if pane else []
        elif not (pane and line.startswith(b"usemtl")):
            lines.append(line)
    return b"\n".join(lines) + b"\n"
