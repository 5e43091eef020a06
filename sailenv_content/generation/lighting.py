"""Sky, sun, windows and lamps of a generated room: a time of the day in, entries of a file out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from sailenv_content.generation.items import Item
from sailenv_content.generation.plan import Area, WallGap, WallSide
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_models import LightRule

__all__ = ["environment_entry", "light_entries", "times_of"]

MAX_LAMPS = 6
"""Lamps that shine, so that baking their light takes no longer than that of the rest."""

FLOOR_M2 = 14.0
"""Floor area for which the rules' ceiling lamps are meant [m²]; their power is scaled for
others."""

_LEAST_SHARE, _MOST_SHARE = 0.4, 1.3

_IN_FRONT_M = 0.2
_BELOW_CEILING_M = 0.3


def times_of(
    times: Sequence[str],
    rules: Mapping[str, LightRule],
    items: Sequence[Item],
    areas: Sequence[Area],
) -> Sequence[str]:
    """Return the times of the day that suit a room: not those of lamps, if it has none.

    A lamp that stands on the floor or hangs from the ceiling is asked for in each of its areas.
    """
    lamps = [item for item in items if item.light is not None and item.rule is not None]
    if all(any(area.holds(lamp.block) for lamp in lamps) for area in areas):
        return times
    return [time for time in times if not rules[time].lamps] or times


def environment_entry(rule: LightRule, dice: RandomStream) -> dict[str, Any]:
    """Return the surroundings."""
    entry: dict[str, Any] = {}
    if rule.sky_maps:
        entry["sky_map"] = dice.one(rule.sky_maps)
    entry |= {
        "ambient": list(rule.ambient),
        "sky_share": rule.sky_share,
        "sky_zenith": list(rule.sky_zenith),
        "sky_horizon": list(rule.sky_horizon),
        "sky_ground": list(rule.sky_ground),
        "exposure": round(dice.between(rule.exposure), 2),
        "meter_exposure": True,
    }
    return entry


def light_entries(
    rule: LightRule,
    windows: Sequence[tuple[WallSide, WallGap]],
    items: Sequence[Item],
    heights: dict[str, float],
    areas: Sequence[Area],
    dice: RandomStream,
) -> Iterator[dict[str, Any]]:
    """Yield the lights: sun, windows, lamps.

    Parameters
    ----------
    rule : LightRule
    windows : sequence of (WallSide, WallGap)
    items : sequence of Item
    heights : dict of str to float
        Of the origin of each lamp that has a light, by its name [m].
    areas : sequence of Area
        The rooms.
    dice : RandomStream
    """
    if rule.sun is not None and windows:
        side, _ = max(windows, key=lambda w: (w[1].along[1] - w[1].along[0], w[0].wall))
        yield _sun(rule, side, dice)
    for number, (side, hole) in enumerate(windows, start=1):
        x, y = side.point((hole.along[0] + hole.along[1]) / 2.0, _IN_FRONT_M)
        yield {
            "name": "window light" if number == 1 else f"window light {number}",
            "type": "area",
            "position": _rounded(x, y, (hole.up[0] + hole.up[1]) / 2.0),
            "direction": [side.inward[0], side.inward[1], -0.25],
            "width": round(hole.along[1] - hole.along[0], 2),
            "height": round(hole.up[1] - hole.up[0], 2),
            "colour": list(rule.window_colour),
            "intensity": round(dice.between(rule.window), 2),
        }
    yield from _lamps(rule, items, heights, areas, dice)


def _sun(rule: LightRule, side: WallSide, dice: RandomStream) -> dict[str, Any]:
    assert rule.sun is not None
    up = math.radians(dice.between(rule.sun.elevation))
    yaw = math.radians(side.yaw_deg + dice.between(rule.sun.aside))
    direction = (math.cos(yaw) * math.cos(up), math.sin(yaw) * math.cos(up), -math.sin(up))
    return {
        "name": "sun",
        "type": "directional",
        "direction": [round(part, 2) for part in direction],
        "colour": list(rule.sun.colour),
        "intensity": round(dice.between(rule.sun.intensity), 1),
    }


def _lamps(
    rule: LightRule,
    items: Sequence[Item],
    heights: dict[str, float],
    areas: Sequence[Area],
    dice: RandomStream,
) -> Iterator[dict[str, Any]]:
    count = 0
    for item in items:
        if item.light is None or count == MAX_LAMPS:
            continue
        up, strength = item.light.at[2], item.light.power
        ceiling = item.rule is not None and item.rule.at == "ceiling"
        if not ceiling and not rule.lamps:
            continue
        count += 1
        z = heights.get(item.name, 0.0) + up
        if ceiling:
            small = item.block.high - item.block.low < 0.2
            if small:
                strength = round(dice.between(rule.ceiling) * _share(item, areas), 2)
            z -= _BELOW_CEILING_M if small else 0.0
        x, y = item.light_xy
        yield {
            "name": f"light of {item.name}",
            "type": "point",
            "position": _rounded(x, y, z),
            "colour": list(rule.lamp_colour),
            "intensity": strength,
        }


def _share(item: Item, areas: Sequence[Area]) -> float:
    """Return how much light a ceiling lamp's room needs, against that of the rules."""
    floor_m2 = next((a.floor_m2 for a in areas if a.holds(item.block)), FLOOR_M2)
    return min(_MOST_SHARE, max(_LEAST_SHARE, floor_m2 / FLOOR_M2))


def _rounded(*values: float) -> list[float]:
    return [round(value, 2) for value in values]
