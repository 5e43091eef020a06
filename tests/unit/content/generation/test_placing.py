"""Where things are put: pictures at eye level, pots on hobs, nothing before the television."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from pydantic import ValidationError

from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.furnishing import Furnisher
from sailenv_content.generation.items import Item, Namer, block_of
from sailenv_content.generation.lighting import times_of
from sailenv_content.generation.plan import Area, Block, RoomPlan
from sailenv_content.generation.room_shapes import outer_sides
from sailenv_content.generation.things import lay_things
from sailenv_ros.assets.arranging import arranged
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import rules_of
from sailenv_ros.scene.spec import ObjectSpec

HALF = (3.4, 2.6)
HEIGHT_M = 2.6
HANGS_BESIDE_M = 0.149


@pytest.fixture(scope="module")
def stock() -> AssetIndex:
    return AssetIndex(AssetLibrary(installed_sources(installed_packs())))


def furnisher(stock: AssetIndex, seed: int) -> Furnisher:
    """Return one that furnishes an empty rectangle without doors and windows."""
    low, high = (-HALF[0], -HALF[1]), HALF
    walls = tuple(outer_sides(low, high))
    area = Area(name="", kind="living_room", low=low, high=high, height=HEIGHT_M, walls=walls)
    plan = RoomPlan(areas=[area], doors=[(0.0, 0.0)])
    dice = RandomStream("placing", seed, 0, "test")
    return Furnisher(
        area=area, plan=plan, rules=rules_of(), stock=stock, dice=dice, namer=Namer(),
        skirting_m=0.015,
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(4))
def test_pictures_hang_at_eye_level_apart_from_their_neighbours(
    stock: AssetIndex, seed: int
) -> None:
    room = furnisher(stock, seed)
    for name in ("high cupboard", "bookcase", *["painting"] * 6, "clock", "wall shelf"):
        room.place(name)
    hung = [item for item in room.items if item.rule is not None and item.rule.eye_level]
    assert len(hung) >= 5
    for item in hung:
        assert item.rule is not None
        assert item.rule.eye_level is not None
        least, most = item.rule.eye_level
        assert least - 0.01 <= (item.block.low + item.block.high) / 2.0 <= most + 0.01
        for other in room.items:
            assert other is item or not item.block.meets(other.block, HANGS_BESIDE_M)


@pytest.mark.parametrize("seed", range(4))
def test_pictures_over_something_hang_clear_of_it(stock: AssetIndex, seed: int) -> None:
    room = furnisher(stock, seed)
    for _ in range(3):
        room.place("sideboard")
        room.place("bed")
    over = [item for item in room.items if item.base in ("wide painting", "bed painting")]
    assert over
    for picture in over:
        below = [
            item for item in room.items if item.side is picture.side and item.block.low < 0.1
            and abs(item.along_m - picture.along_m) < 0.01
        ]  # fmt: skip
        assert below
        assert picture.block.low >= max(item.block.high for item in below) + 0.11


@pytest.mark.parametrize("seed", range(6))
def test_nothing_comes_between_television_and_couch(stock: AssetIndex, seed: int) -> None:
    room = furnisher(stock, seed)
    assert room.place("tv cabinet")
    (couch,) = (item for item in room.items if item.base == "couch")
    (cabinet,) = (item for item in room.items if item.base == "tv cabinet")
    group = len(room.items)
    for name in ("dining table", *["toy"] * 8, *["stool"] * 8):
        room.place(name)
    later = room.items[group:]
    assert later
    # Points on the way from the one to the other.
    way = np.linspace((cabinet.block.x, cabinet.block.y), (couch.block.x, couch.block.y), 40)
    for item in later:
        if item.block.low < 1.0:
            assert (item.block.distance_m(way) > 0.0).all()


def test_all_chairs_that_a_table_needs_stand_around_it(stock: AssetIndex) -> None:
    for seed in range(6):
        room = furnisher(stock, seed)
        if room.place("dining table"):
            assert sum(item.base == "dining chair" for item in room.items) >= 2


@pytest.mark.parametrize("asset", ["kitchen_unit~modern:1", "kitchen_unit~wall:1"])
def test_on_a_hob_stand_pots_alone_and_nothing_in_a_sink(stock: AssetIndex, asset: str) -> None:
    rules = rules_of()
    rule = rules.furniture["kitchen wall" if "wall" in asset else "kitchen row"]
    row = Item(
        name="row", asset=asset, entry={}, block=block_of(stock, asset, 1.0, 0.0, 0.0, 0.0),
        x=0.0, y=0.0, yaw_deg=0.0, rule=rule,
    )  # fmt: skip
    let_in = stock.let_in(asset)
    assert set(let_in) == {"stove", "sink"}
    on_hob, count = 0, 0
    for seed in range(12):
        dice = RandomStream("things", seed, 0, "test")
        for thing in lay_things([row], rules, stock, dice, Namer()):
            middle = np.array([thing.block.x, thing.block.y])
            inside = {
                name
                for name, (low, high) in let_in.items()
                if (low[:2] < middle).all() and (middle < high[:2]).all()
            }
            pot = thing.asset.startswith("pot~")
            assert inside == ({"stove"} if pot else set())
            on_hob, count = on_hob + pot, count + 1
            # Below cupboards and a hood as well: on the worktop, where it is built there too.
            (height,) = stock.support_heights(asset, 1.0, middle[None], thing.entry["level"])
            assert 0.85 < height < 1.0
    assert on_hob >= 4
    assert count > 24


def test_what_lies_below_cupboards_is_built_there(stock: AssetIndex) -> None:
    asset = stock.asset("kitchen_unit~wall:1")
    x, y = -0.15, float(stock.bounds(asset.name)[1, 1]) - 0.08  # at the end without the hob
    under = np.array([(x, y)])
    (top,) = stock.support_heights(asset.name, 1.0, under)
    (worktop,) = stock.support_heights(asset.name, 1.0, under, (0.8, 1.1))
    assert worktop < 1.0 < 1.9 < top
    assert not np.isfinite(stock.support_heights(asset.name, 1.0, under, (1.1, 1.3))).any()
    place = {"on": "row", "position": (x, y, 0.0)}
    entries = [
        ObjectSpec.model_validate(entry)
        for entry in (
            {"name": "row", "asset": asset.name, "position": (0.0, 0.0, 0.0)},
            {"name": "high", "asset": "cup_01", **place},
            {"name": "low", "asset": "cup_01", "level": (0.8, 1.1), **place},
        )
    ]
    assets = {entry.name: stock.asset(entry.asset) for entry in entries}
    poses = arranged(entries, assets, None)
    assert poses["low"].position_m[2] == pytest.approx(worktop + 0.001, abs=1e-3)
    assert poses["high"].position_m[2] == pytest.approx(top + 0.001, abs=1e-3)
    with pytest.raises(ValidationError, match=r"must be \[least, most\]"):
        ObjectSpec.model_validate({"name": "low", "asset": "cup_01", "level": (2, 1), **place})


def test_a_hood_hangs_over_the_hob_of_a_row_and_nowhere_else(stock: AssetIndex) -> None:
    with_hob = 0
    for seed in range(12):
        asset = stock.asset(f"kitchen_unit~wall:{seed}")
        hoods = [part for part in asset.parts if part.category == "hood"]
        hob = stock.let_in(asset.name).get("stove")
        assert len(hoods) == int(hob is not None)
        with_hob += len(hoods)
        for hood in hoods:
            points = np.concatenate([asset.model.parts[k].mesh.positions for k in hood.meshes])
            assert hob is not None
            low, high = hob
            assert points[:, 1].min() < (low + high)[1] / 2.0 < points[:, 1].max()
    assert 0 < with_hob < 12


@pytest.mark.parametrize("seed", range(6))
def test_a_kitchen_has_a_place_to_cook(stock: AssetIndex, seed: int) -> None:
    pieces = rules_of().kind("kitchen").furniture
    room = furnisher(stock, seed)
    assert room.furnish(pieces)
    hobs = [item for item in room.items if stock.has(item.asset, "stove") or item.base == "stove"]
    assert hobs
    assert any(item.needed for item in hobs)
    # Beside a row without a hob stands a cooker, and nowhere else one.
    rows = [item for item in room.items if item.base in ("kitchen row", "kitchen wall")]
    cookers = [item for item in room.items if item.base in ("cooker", "stove")]
    assert not (rows and stock.has(rows[0].asset, "stove") and cookers)


def test_a_room_without_space_to_cook_is_refused(stock: AssetIndex) -> None:
    room = furnisher(stock, 0)
    room.plan.stand([Block(x=0.0, y=0.0, half_x=HALF[0], half_y=HALF[1])], [])
    cooker = next(p for p in rules_of().kind("kitchen").furniture if p.put == "cooker")
    assert not room.furnish([cooker])


@pytest.mark.parametrize("asset", ["armchair~tub:1", "armchair~shell:2", "sofa~rolled:1"])
def test_cushions_lie_on_the_seat_and_not_across_the_arms(stock: AssetIndex, asset: str) -> None:
    rules = rules_of()
    seat = Item(
        name="seat", asset=asset, entry={}, block=block_of(stock, asset, 1.0, 0.0, 0.0, 0.0),
        x=0.0, y=0.0, yaw_deg=0.0,
        rule=rules.furniture["couch" if "sofa" in asset else "armchair"],
    )  # fmt: skip
    laid = [
        thing
        for seed in range(40)
        for thing in lay_things([seat], rules, stock, RandomStream(seed), Namer())
    ]
    assert laid
    for thing in laid:
        corners = thing.block.corners()
        under = np.vstack([[(thing.block.x, thing.block.y)], corners])
        heights = stock.support_heights(asset, 1.0, under)
        assert heights.max() - heights[0] < 0.07


def test_a_room_without_lamps_is_seen_by_day(stock: AssetIndex) -> None:
    light = rules_of().light
    times = ["noon", "evening", "overcast", "sunset"]
    room = furnisher(stock, 0)
    assert times_of(times, light, room.items, [room.area]) == ["noon", "overcast"]
    assert times_of(["evening"], light, room.items, [room.area]) == ["evening"]
    assert room.place("ceiling lamp")
    assert times_of(times, light, room.items, [room.area]) == times


def test_washbasins_have_nothing_let_in(stock: AssetIndex) -> None:
    for seed, style in itertools.product(range(2), ("cabinet", "bowl", "pedestal")):
        assert not stock.let_in(f"washbasin~{style}:{seed}")
