"""Small robots as URDF texts: an arm with a gripper, a cart on wheels."""

from __future__ import annotations

__all__ = ["ARM", "CART", "CART_BEFORE_A_WALL", "STEERED", "link"]


CART_BEFORE_A_WALL = """
version: 1
objects:
  - {name: floor, asset: cube, static: true, position: [0, 0, -0.5], scale: [10, 10, 1]}
  - {name: wall, asset: cube, static: true, position: [3, 0, 1], scale: [0.2, 8, 2]}
robots:
  - name: cart
    file: cart.urdf
    mount: differential
"""
"""A scene whose last robot may get more keys."""


def link(name: str, mass: float = 1.0, size: str = "0.1 0.1 0.4", z: float = 0.2) -> str:
    """A box above its frame."""
    x, y, h = map(float, size.split())
    moments = [mass * (a * a + b * b) / 12.0 for a, b in ((y, h), (x, h), (x, y))]
    return f"""
  <link name="{name}">
    <inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>
      <inertia ixx="{moments[0]}" iyy="{moments[1]}" izz="{moments[2]}" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual><origin xyz="0 0 {z}"/><geometry><box size="{size}"/></geometry>
      <material name="{name}"><color rgba="0.8 0.3 0.1 1"/></material></visual>
    <collision><origin xyz="0 0 {z}"/><geometry><box size="{size}"/></geometry></collision>
  </link>"""


def _joint(
    name: str, kind: str, parent: str, child: str, xyz: str, axis: str, more: str = ""
) -> str:
    return f"""
  <joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
    <origin xyz="{xyz}"/><axis xyz="{axis}"/>{more}</joint>"""


_LIMIT = '<limit lower="{}" upper="{}" effort="{}" velocity="{}"/>'

ARM = (
    '<robot name="arm">'
    + link("base", 5.0, "0.3 0.3 0.2", 0.1)
    + link("upper")
    + link("lower")
    + link("left", 0.1, "0.04 0.02 0.1", 0.05)
    + link("right", 0.1, "0.04 0.02 0.1", 0.05)
    + '<link name="tip"/>'
    + _joint(
        "shoulder", "revolute", "base", "upper", "0 0 0.2", "0 1 0", _LIMIT.format(-2, 2, 80, 3)
    )
    + _joint("elbow", "revolute", "upper", "lower", "0 0 0.4", "0 1 0", _LIMIT.format(-2, 2, 40, 3))
    + _joint(
        "grip", "prismatic", "lower", "left", "0 0.02 0.42", "0 1 0", _LIMIT.format(0, 0.05, 30, 1)
    )
    + _joint(
        *("grip 2", "prismatic", "lower", "right", "0 -0.02 0.42", "0 -1 0"),
        _LIMIT.format(0, 0.05, 30, 1) + '<mimic joint="grip"/>',
    )
    + _joint("tip joint", "fixed", "lower", "tip", "0 0 0.5", "0 0 1")
    + "</robot>"
)
"""Two links and a gripper, of which one finger follows the other; all stands upright at 0."""


def _wheel(name: str) -> str:
    shape = '<geometry><cylinder radius="0.1" length="0.05"/></geometry>'
    turned = '<origin rpy="1.5707963267948966 0 0"/>'
    return f"""
  <link name="{name}">
    <inertial><mass value="0.5"/>
      <inertia ixx="0.0014" iyy="0.0025" izz="0.0014" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual>{turned}{shape}</visual><collision>{turned}{shape}</collision>
  </link>"""


_CORNERS = {
    "front_left": "0.2 0.2 0.1",
    "front_right": "0.2 -0.2 0.1",
    "rear_left": "-0.2 0.2 0.1",
    "rear_right": "-0.2 -0.2 0.1",
}

CART = (
    '<robot name="cart">'
    + link("chassis", 20.0, "0.5 0.3 0.1", 0.15)
    + "".join(_wheel(name) for name in _CORNERS)
    + "".join(
        _joint(f"{name} joint", "continuous", "chassis", name, xyz, "0 1 0")
        for name, xyz in _CORNERS.items()
    )
    + "</robot>"
)
"""A chassis whose frame is on the floor, on four wheels of 0.1 m, 0.4 m apart both ways."""

STEERED = (
    '<robot name="car">'
    + link("chassis", 20.0, "0.5 0.2 0.1", 0.15)
    + "".join(_wheel(name) for name in _CORNERS)
    + "".join(link(f"{name} hub", 0.5, "0.02 0.02 0.02", 0.0) for name in list(_CORNERS)[:2])
    + "".join(
        _joint(
            *(f"{name} steering", "revolute", "chassis", f"{name} hub", xyz, "0 0 1"),
            _LIMIT.format(-0.7, 0.7, 10, 5),
        )
        + _joint(f"{name} joint", "continuous", f"{name} hub", name, "0 0 0", "0 1 0")
        if name.startswith("front")
        else _joint(f"{name} joint", "continuous", "chassis", name, xyz, "0 1 0")
        for name, xyz in _CORNERS.items()
    )
    + "</robot>"
)
"""A narrower one with steered front wheels, which need room."""
