"""A small scene of built-in solids, for environments: two boxes and a ball upon a floor."""

from __future__ import annotations

from pathlib import Path

PLAIN_ROOM = """\
version: 1
name: {name}
environment: {{ambient: [0.4, 0.4, 0.4]}}
lights:
  - {{name: sun, type: directional, direction: [0.5, 0.4, -0.8], intensity: 2}}
objects:
  - {{name: ground, asset: plane, category: floor, static: true, scale: [5, 4, 1]}}
  - {{name: box, asset: cube, category: couch, position: [1, 0.6, 0.4], scale: 0.8, static: true}}
  - {{name: cot, asset: cube, category: bed, position: [-1.2, -0.8, 0.3], scale: 0.6, static: true}}
  - {{name: bench, asset: cube, position: [-1, 1.2, 0.3], scale: [1.2, 0.8, 0.6], static: true}}
  - {{name: mug, asset: cylinder, category: bowl, position: [-1.2, 1.2, 0.65], scale: 0.1}}
  - name: flap
    asset: cube
    category: door
    position: [2.2, -1.2, 1]
    scale: [0.05, 0.8, 2]
    joint: {{type: hinge, origin: [0, 0.4, 0], limits: [-1.6, 0]}}
  - {{name: ball, asset: sphere, category: cup, position: [1, 0.6, 0.95], scale: 0.3, static: true}}
"""


def plain_room(folder: Path, name: str = "plain") -> str:
    """Write the scene; return what environments take as a room's name."""
    path = folder / f"{name}.yaml"
    path.write_text(PLAIN_ROOM.format(name=name), encoding="utf-8")
    return str(path)
