"""Materials of walls and floors, made by code: seeded, tiling, at real-world scale."""

from sailenv_ros.assets.surfaces.catalogue import surface, surface_names
from sailenv_ros.assets.surfaces.maps import Surface

__all__ = ["Surface", "surface", "surface_names"]
