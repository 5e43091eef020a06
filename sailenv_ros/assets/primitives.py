"""The built-in assets: plain solids that need no file. A source of the `AssetLibrary`.

Each is 1 m large and has its origin at its centre of mass, but for `plane`, whose origin lies in
its upper face. Physics shapes are exact, not those of the triangles.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from sailenv_ros.assets.solids import (
    box_mesh,
    cone_mesh,
    cylinder_mesh,
    ground_mesh,
    sphere_mesh,
)
from sailenv_ros.types.model import (
    Asset,
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    Material,
    Mesh,
    Model,
    ModelPart,
    SphereShape,
)

__all__ = ["Primitives"]

PLANE_SIZE_M = 10.0
PLANE_THICKNESS_M = 0.1


class Primitives:
    """The source of `cube`, `sphere`, `cylinder`, `cone` and `plane`."""

    @property
    def display_names(self) -> Mapping[str, str]:
        """Display name of each catalogue name."""
        return MappingProxyType({name: name.capitalize() for name in _MAKERS})

    def load(self, name: str) -> Asset:
        """Make one of them."""
        return _MAKERS[name]()


def _cube() -> Asset:
    """1 m edge."""
    return _asset("cube", box_mesh((1.0, 1.0, 1.0)), BoxShape(half_extents_m=(0.5, 0.5, 0.5)))


def _sphere() -> Asset:
    """1 m diameter."""
    return _asset("sphere", sphere_mesh(0.5), SphereShape(radius_m=0.5))


def _cylinder() -> Asset:
    """1 m diameter, 1 m high, along z."""
    return _asset("cylinder", cylinder_mesh(0.5, 1.0), CylinderShape(radius_m=0.5, height_m=1.0))


def _cone() -> Asset:
    """1 m base diameter, 1 m high, tip up; a cone's centre of mass is a quarter up its height."""
    mesh = cone_mesh(0.5, -0.25, 0.75)
    points = np.unique(mesh.positions.astype(np.float64), axis=0)
    return _asset("cone", mesh, ConvexShape(points=points))


def _plane() -> Asset:
    """10 m wide and long, seen from above only; it collides as a slab below its face."""
    half = PLANE_SIZE_M / 2.0
    slab = BoxShape(
        half_extents_m=(half, half, PLANE_THICKNESS_M / 2.0),
        centre_m=(0.0, 0.0, -PLANE_THICKNESS_M / 2.0),
    )
    return _asset("plane", ground_mesh(PLANE_SIZE_M), slab, centre_z_m=-PLANE_THICKNESS_M / 2.0)


def _asset(name: str, mesh: Mesh, shape: CollisionShape, *, centre_z_m: float = 0.0) -> Asset:
    material = Material(name=name, base_colour=(0.6, 0.6, 0.6, 1.0), roughness=0.5)
    return Asset(
        name=name,
        display_name=name.capitalize(),
        category=name,
        model=Model(name=name, parts=(ModelPart(mesh=mesh, material=material),)),
        collision=(shape,),
        mass_kg=1.0,
        centre_of_mass_m=(0.0, 0.0, centre_z_m),
        tags=("primitive",),
    )


_MAKERS: Mapping[str, Callable[[], Asset]] = MappingProxyType(
    {"cube": _cube, "sphere": _sphere, "cylinder": _cylinder, "cone": _cone, "plane": _plane}
)
