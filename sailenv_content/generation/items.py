"""Objects placed by a generator: their keys in a scene file, and their places in the plan."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.plan import Block, WallSide
from sailenv_ros.authoring.room_rules.rule_models import FurnitureRule

__all__ = ["Item", "Lamp", "Namer", "block_of", "clear_blocks"]


@dataclass(frozen=True, slots=True)
class Lamp:
    """Where the light of a lamp is, in the axes of its body [m], and its power [W/sr]."""

    at: tuple[float, float, float]
    power: float


@dataclass(slots=True, kw_only=True)
class Item:
    """An object that has its place.

    Attributes
    ----------
    name : str
        Unique in the scene.
    asset : str
    entry : dict
        Its keys in the scene file, but for name and asset.
    block : Block
        The room that it takes.
    x, y, yaw_deg : float
        Pose of its origin [m, deg].
    scale : float
    rule : FurnitureRule or None
        What it is; None for a thing that lies on something.
    side : WallSide or None
        The wall that it has at its back.
    along_m : float
        Its place along that wall [m].
    needed : bool
        True if the room is nothing without it.
    section : str
        Heading in the file.
    base : str
        Name of its piece in ``furniture.yaml``; empty for things.
    around : list of Item
        Chairs around a table.
    clear : tuple of Block
        Floor that it keeps free.
    light : Lamp or None
    """

    name: str
    asset: str
    entry: dict[str, Any]
    block: Block
    x: float
    y: float
    yaw_deg: float
    scale: float = 1.0
    rule: FurnitureRule | None = None
    side: WallSide | None = None
    along_m: float = 0.0
    needed: bool = False
    section: str = ""
    base: str = ""
    around: list[Item] = field(default_factory=list)
    clear: tuple[Block, ...] = ()
    light: Lamp | None = None

    @property
    def is_flat(self) -> bool:
        """Whether others may stand on it."""
        return self.rule is not None and self.rule.flat

    @property
    def light_xy(self) -> tuple[float, float]:
        """Where its light is in the room, seen from above [m]."""
        ahead, aside = (0.0, 0.0) if self.light is None else self.light.at[:2]
        c, s = math.cos(math.radians(self.yaw_deg)), math.sin(math.radians(self.yaw_deg))
        return self.x + c * ahead - s * aside, self.y + s * ahead + c * aside

    def described(self) -> dict[str, Any]:
        """Return its keys in a scene file."""
        return {"name": self.name, "asset": self.asset, **self.entry}


class Namer:
    """Names that no other object of the scene has: lamp, lamp 2, lamp 3."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)
        self._counts: Counter[str] = Counter()

    def name(self, base: str) -> str:
        """Return the next free name."""
        while True:
            self._counts[base] += 1
            number = self._counts[base]
            name = base if number == 1 else f"{base} {number}"
            if name not in self._taken:
                self._taken.add(name)
                return name


def block_of(
    stock: AssetIndex, asset: str, scale: float, x: float, y: float, yaw_deg: float, z: float = 0.0
) -> Block:
    """Return the room that an object takes whose origin stands somewhere."""
    low, high = stock.bounds(asset, scale)
    yaw = math.radians(yaw_deg)
    middle = (low + high) / 2.0
    c, s = math.cos(yaw), math.sin(yaw)
    return Block(
        x=x + c * middle[0] - s * middle[1],
        y=y + s * middle[0] + c * middle[1],
        half_x=float(high[0] - low[0]) / 2.0,
        half_y=float(high[1] - low[1]) / 2.0,
        yaw_rad=yaw,
        low=z + float(low[2]),
        high=z + float(high[2]),
    )


def clear_blocks(rule: FurnitureRule, block: Block) -> tuple[Block, ...]:
    """Return the floor that a piece of furniture keeps free, from knee to head."""
    asked: Mapping[tuple[float, float], float] = {
        (1.0, 0.0): rule.clear.front,
        (0.0, 1.0): rule.clear.left,
        (0.0, -1.0): rule.clear.right,
    }
    blocks = []
    for (ahead, aside), depth in asked.items():
        if depth <= 0.0:
            continue
        half = (depth / 2.0, block.half_y) if ahead else (block.half_x, depth / 2.0)
        offset = np.array([ahead * (block.half_x + half[0]), aside * (block.half_y + half[1])])
        x, y = (offset @ block.axes() + (block.x, block.y)).tolist()
        blocks.append(
            Block(
                x=x, y=y, half_x=half[0], half_y=half[1], yaw_rad=block.yaw_rad, low=0.02, high=1.9
            )
        )
    return tuple(blocks)
