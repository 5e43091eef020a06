"""The space of a scene: where a body can stand and walk, and what a ray meets."""

from sailenv_ros.space.free_space import FREE, OCCUPIED, UNKNOWN, FreeSpace
from sailenv_ros.space.ray_hits import RayCast

__all__ = ["FREE", "OCCUPIED", "UNKNOWN", "FreeSpace", "RayCast"]
