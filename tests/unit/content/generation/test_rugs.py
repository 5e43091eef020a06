"""What stands on a rug: wholly upon it, or on the floor where only its edge is below."""

from __future__ import annotations

from typing import Any

import pytest

from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.items import Item, block_of
from sailenv_content.generation.rugs import on_its_edge, stand_on_rugs
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.authoring.room_rules.rule_files import rules_of
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.world.build import build_world
from sailenv_ros.world.physics_check import RUG_GIVES_M, overlaps

RUG, ROUND, CHAIR = "rug~modern:3", "rug~round:3", "chair~dining:4"


@pytest.fixture(scope="module")
def stock() -> AssetIndex:
    return AssetIndex(AssetLibrary(installed_sources(installed_packs())))


def item(
    stock: AssetIndex, asset: str, piece: str, x: float = 0.0, y: float = 0.0, yaw: float = 0.0,
    *, static: bool = True, scale: float = 1.0,
) -> Item:  # fmt: skip
    entry: dict[str, Any] = {"position": [x, y, 0.001], "rotation": [0, 0, yaw], "scale": scale}
    return Item(
        name=piece, asset=asset, entry={**entry, "static": static}, x=x, y=y, yaw_deg=yaw,
        block=block_of(stock, asset, scale, x, y, yaw), rule=rules_of().furniture[piece],
        scale=scale,
    )  # fmt: skip


def height(piece: Item, rug: Item, stock: AssetIndex) -> float:
    stand_on_rugs([rug, piece], stock)
    return float(piece.entry["position"][2])


@pytest.mark.parametrize("yaw", [0.0, 30.0])
def test_what_stands_wholly_on_a_rug_stands_upon_it(stock: AssetIndex, yaw: float) -> None:
    rug = item(stock, RUG, "large rug", yaw=yaw)
    top = float(stock.bounds(RUG)[1, 2])
    assert 0.006 < top < RUG_GIVES_M
    chair = item(stock, CHAIR, "dining chair", 0.1, 0.2, yaw)
    assert height(chair, rug, stock) == pytest.approx(top + 0.001)


def test_a_thin_rug_gives_way_at_its_edge(stock: AssetIndex) -> None:
    rug = item(stock, RUG, "large rug")
    edge = float(stock.bounds(RUG)[1, 1])
    assert height(item(stock, CHAIR, "dining chair", 0.0, edge), rug, stock) == 0.001
    assert height(item(stock, CHAIR, "dining chair", 0.0, edge + 1.0), rug, stock) == 0.001
    # What is loose would be pushed out of it, and a thick one stays as it is.
    loose = item(stock, CHAIR, "dining chair", 0.0, edge, static=False)
    assert height(loose, rug, stock) > 0.006
    thick = item(stock, RUG, "large rug", scale=3.0)
    chair = item(stock, CHAIR, "dining chair", 0.0, 3.0 * edge)
    assert height(chair, thick, stock) > RUG_GIVES_M


def test_a_corner_of_the_box_around_a_round_rug_is_bare_floor(stock: AssetIndex) -> None:
    rug = item(stock, ROUND, "large rug")
    reach = float(stock.bounds(ROUND)[1, 0])
    assert on_its_edge(rug, item(stock, CHAIR, "dining chair", 0.8 * reach, 0.8 * reach), stock)
    assert not on_its_edge(rug, item(stock, CHAIR, "dining chair"), stock)


def test_checks_let_furniture_stand_in_a_rug_and_nothing_else(stock: AssetIndex) -> None:
    edge = float(stock.bounds(RUG)[1, 1])
    rug = item(stock, RUG, "large rug")
    chair = item(stock, CHAIR, "dining chair", 0.0, edge)

    def found(*items: Item) -> int:
        objects = [each.described() for each in items]
        spec = SceneSpec.model_validate({"version": 1, "name": "test", "objects": objects})
        world = build_world(
            spec, assets=stock.assets, categories=load_categories(), seed=0, epoch=1,
            next_revision=iter(range(1, 99)).__next__,
        )  # fmt: skip
        try:
            return len(list(overlaps(world)))
        finally:
            world.close()

    assert found(rug, chair) == 0
    loose = item(stock, CHAIR, "dining chair", 0.0, edge, static=False)
    assert found(rug, loose) == 1
    assert found(item(stock, "cube", "large rug"), item(stock, CHAIR, "dining chair")) == 1
