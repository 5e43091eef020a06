"""A room that has not passed its checks yet: what may lie where it came to rest, what may go."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.checks import Fault
from sailenv_content.generation.items import Item
from sailenv_content.generation.plan import RoomPlan
from sailenv_content.generation.shells import Shell
from sailenv_ros.authoring.room_rules.rule_models import KindFile
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.world.opening_pieces import moving_name

__all__ = ["Draft"]


@dataclass(slots=True, kw_only=True)
class Draft:
    """A room that has not passed the checks yet."""

    kind: str
    file: KindFile
    seed: int
    attempt: int
    shell: Shell
    plan: RoomPlan
    items: list[Item]
    stock: AssetIndex
    waypoints: Sequence[tuple[float, ...]] = ()

    def spec_of(self, data: dict[str, Any]) -> SceneSpec:
        """Return what a scene file says, checked."""
        return SceneSpec.model_validate({"name": f"{self.kind}_{self.seed}", **data})

    def settle(self, fault: Fault) -> bool:
        """Let a thing lie where it came to rest, once; say if it may."""
        item = next((i for i in self.items if i.name in fault.names), None)
        if item is None or fault.rests_at is None or item.name in self._settled:
            return False
        self._settled.add(item.name)
        kept = {key: item.entry[key] for key in ("scale",) if key in item.entry}
        position = [round(value, 4) for value in fault.rests_at.position_m]
        rotation = [round(value, 2) for value in fault.rests_at.rpy_deg]
        item.entry = {"position": position, "rotation": rotation, **kept}
        return True

    def take_out(self, names: Sequence[str]) -> bool:
        """Take out the least of some objects with what lies on it; say if that can be done."""
        owners = self._owners()
        blamed = {owners.get(name, name) for name in names}
        present = [item for item in self.items if item.name in blamed]
        if not present:
            # Taken out already, with what carried it, or a part of the room alone.
            return not self._gone.isdisjoint(blamed.union(names))
        loose = [item for item in present if not item.needed]
        if not loose:
            return False
        # Things go before furniture, the last placed first.
        victim = max(loose, key=lambda item: (item.rule is None, self.items.index(item)))
        gone = {victim.name}
        while True:
            more = {i.name for i in self.items if i.entry.get("on") in gone} - gone
            if not more:
                break
            gone |= more
        self._gone |= gone | {part for part, owner in owners.items() if owner in gone}
        self.items = [item for item in self.items if item.name not in gone]
        return True

    def _owners(self) -> dict[str, str]:
        """Return the piece of each door and drawer, by their names."""
        return {
            moving_name(item.name, part.name): item.name
            for item in self.items
            for part in self.stock.asset(item.asset).moving
        }

    _gone: set[str] = field(default_factory=set)
    _settled: set[str] = field(default_factory=set)

    def eyes(self) -> list[tuple[float, float, float]]:
        """Return the places from which objects have to be seen: those that the camera comes by."""
        corners = [(x, y, 1.5) for x, y, *_ in self.waypoints]
        between = [
            ((a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0, 1.5)
            for a, b in zip(corners, [*corners[1:], *corners[:1]], strict=True)
            if math.dist(a, b) > 1.0
        ]
        return [*corners, *between]
