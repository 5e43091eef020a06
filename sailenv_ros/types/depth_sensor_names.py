"""Names of the depth sensors that are modelled: those of the files in `config/sensors`."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from sailenv_ros.errors import UnknownName
from sailenv_ros.system.resources import resource_path

__all__ = ["IDEAL", "depth_sensor_file", "depth_sensor_names"]

IDEAL = "ideal"
"""The sensor that errs nowhere; it has no file."""


@lru_cache(maxsize=1)
def depth_sensor_names() -> tuple[str, ...]:
    """Return all names, `IDEAL` first."""
    files = resource_path("config", "sensors").glob("*.yaml")
    return (IDEAL, *sorted(path.stem for path in files))


def depth_sensor_file(name: str) -> Path:
    """Return the file of a sensor.

    Raises
    ------
    UnknownName
        If there is none of that name; the ideal one has no file.
    """
    if name == IDEAL or name not in depth_sensor_names():
        raise UnknownName("depth sensor", name, depth_sensor_names()[1:])
    return resource_path("config", "sensors", f"{name}.yaml")
