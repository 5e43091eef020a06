"""Light for scenes that bring none along."""

from __future__ import annotations

from sailenv_content.scene_import.imported import Entry, ImportedScene

__all__ = ["ENVIRONMENT", "SUN", "add_daylight"]

SUN: Entry = {
    "name": "sun",
    "type": "directional",
    "direction": [-0.5, 0.55, -0.67],
    "colour": "#ffedd2",
    "intensity": 8.0,
}
"""Sunlight from the south-east, as in the rooms."""

ENVIRONMENT: Entry = {"ambient": [0.1, 0.1, 0.105], "sky_share": 0.15}
"""Surroundings of rooms, whose windows let in a part of the sky's light."""


def add_daylight(scene: ImportedScene) -> None:
    """Add a sun and the light of an open sky."""
    scene.lights.append({**SUN, "intensity": 2.5})
    scene.environment.update({"ambient": [0.35, 0.37, 0.4]})
