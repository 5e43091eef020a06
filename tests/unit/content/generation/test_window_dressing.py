"""Curtains and blinds fit their windows, to the millimetre of what a file can say."""

from __future__ import annotations

from contextlib import closing

import numpy as np
import pytest

from sailenv_content.families.source import FamilySource
from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.items import Item, Namer
from sailenv_content.generation.pieces import PieceChooser
from sailenv_content.generation.plan import Area, Block, RoomPlan, WallGap
from sailenv_content.generation.room_shapes import outer_sides
from sailenv_content.generation.window_dressing import ABOVE_SILL_M, FOOT_M, WindowDresser
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import rules_of
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.world.build import build_world

STOCK = AssetIndex(AssetLibrary([FamilySource()]))
WINDOW, HEIGHT_M = ((1.5, 3.1), (0.85, 2.2)), 2.6
STEP_M = 0.002
"""Scales are rounded to thousandths, and pieces are up to 2.3 m large."""


def dressed(*, curtains: bool, kind: str = "bedroom", seed: int = 0) -> tuple[list[Item], RoomPlan]:
    """Dress one window of 1.6 m in the wall to the north of a room of 5 by 4 m."""
    along, up = WINDOW
    hole = WallGap(along=along, up=up, kind="window", curtains=curtains)
    sides = outer_sides((-2.5, -2.0), (2.5, 2.0))
    walls = tuple(
        type(side)(
            wall=side.wall, start=side.start, end=side.end, inward=side.inward,
            holes=(hole,) if side.wall == "north" else (),
        )
        for side in sides
    )  # fmt: skip
    area = Area(name="", kind=kind, low=(-2.5, -2.0), high=(2.5, 2.0), height=HEIGHT_M, walls=walls)
    plan = RoomPlan(areas=[area], doors=[(0.0, -1.5), (1.0, -1.5)])
    rules = rules_of()
    always = rules.kind(kind).windows.model_copy(update={"blinds": 1.0})
    kinds = {**rules.kinds, kind: rules.kind(kind).model_copy(update={"windows": always})}
    dice = RandomStream("test", seed)
    dresser = WindowDresser(
        area=area, plan=plan, rules=type(rules)(
            kinds=kinds, furniture=rules.furniture, things=rules.things,
            materials=rules.materials, light=rules.light,
        ),
        stock=STOCK, dice=dice, pieces=PieceChooser(dice), namer=Namer(),
    )  # fmt: skip
    return list(dresser.items()), plan


def extent(item: Item) -> np.ndarray:
    """Return (2, 3): where a piece is from the wall, along it, and upwards [m]."""
    low, high = STOCK.bounds(item.asset)
    scale = np.asarray(item.entry["scale"])
    along = 2.5 + item.entry["at"]
    bounds = np.stack([low, high]) * scale
    bounds[:, 1] += along
    bounds[:, 2] += item.entry["height"]
    return np.asarray(bounds)


@pytest.mark.parametrize("seed", range(4))
def test_curtains_reach_beyond_the_window_and_down_to_the_floor(seed: int) -> None:
    (item,), plan = dressed(curtains=True, seed=seed)
    rule = rules_of().furniture["drapes"].window
    assert rule is not None
    low, high = extent(item)
    assert item.asset.startswith("curtain~")
    assert low[1] == pytest.approx(WINDOW[0][0] - rule.aside, abs=STEP_M)
    assert high[1] == pytest.approx(WINDOW[0][1] + rule.aside, abs=STEP_M)
    assert low[2] == pytest.approx(FOOT_M, abs=STEP_M)
    assert high[2] == pytest.approx(WINDOW[1][1] + rule.above, abs=2 * STEP_M)
    # The middle of the window stays free for what stands below it, its sides do not.
    middle, edge = (Block(x=x, y=1.9, half_x=0.2, half_y=0.05) for x in (-0.2, -1.2))
    assert plan.is_free(middle)
    assert not plan.is_free(edge)


@pytest.mark.parametrize("seed", range(4))
def test_blinds_cover_the_window_above_its_sill(seed: int) -> None:
    (item,), _ = dressed(curtains=False, seed=seed)
    rule = rules_of().furniture["blind"].window
    assert rule is not None
    low, high = extent(item)
    assert item.asset.startswith("blind~")
    assert high[1] - low[1] == pytest.approx(1.6 + 2.0 * rule.aside, abs=STEP_M)
    assert low[2] == pytest.approx(WINDOW[1][0] + ABOVE_SILL_M, abs=STEP_M)
    assert high[2] == pytest.approx(WINDOW[1][1] + rule.above, abs=2 * STEP_M)


@pytest.mark.parametrize(
    "style",
    sorted(
        {
            asset
            for rule in rules_of().furniture.values()
            if rule.window is not None
            for asset in rule.assets
        }
    ),
)
def test_what_hangs_can_be_made_to_fit(style: str) -> None:
    """A world takes each style wider and lower than it is."""
    entry = {"name": "it", "asset": style.replace("*", "1"), "static": True, "scale": [1, 1.3, 0.8]}
    spec = SceneSpec.model_validate({"name": "test", "version": 1, "objects": [entry]})
    with closing(build_world(spec, assets=STOCK.assets, categories=load_categories())) as world:
        body = next(one for one in world.bodies if one.placement.name == "it")
        assert body.placement.entry is not None
        assert body.placement.entry.scale == (1.0, 1.3, 0.8)
