"""Materials of walls and floors, made by code: seeded, tiling, at real-world scale."""

from sailenv_ros.assets.surfaces.maps import Surface
from sailenv_ros.assets.surfaces.surface_catalogue import surface, surface_names

__all__ = ["Surface", "surface", "surface_names"]
