"""Pieces from seeds: equal bytes, whole meshes, joints that move clear, names that are refused."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_content.families.builder import PieceBuilder, Unfit
from sailenv_content.families.family import Family, Style
from sailenv_content.families.making import MAX_DRAWS, Piece, make_piece
from sailenv_content.families.materials import wood
from sailenv_content.families.names import PieceName
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.registry import family_named, family_names
from sailenv_content.families.source import FamilySource
from sailenv_ros.assets.arranging import shape_points, support_heights
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.meshes import RawMesh, components
from sailenv_ros.errors import AssetError, SceneError, UnknownName
from sailenv_ros.render.scene.flat_mirrors import FlatMirrors
from sailenv_ros.scene.loader import SceneKnowledge, load_scene
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.build import build_world
from sailenv_ros.world.kinematics import link_pose
from sailenv_ros.world.world import World
from tests.support.coplanar import shared_faces
from tests.support.tiny_scenes import Thing, camera_at, snapshot_of

LIBRARY = AssetLibrary([FamilySource()])

STYLES = [(name, style) for name in family_names() for style in family_named(name).styles]


def made(family: str, style: str, seed: int) -> Piece:
    """Make a piece, whatever is kept."""
    return make_piece(family_named(family), PieceName(family, style, seed))


def every_array(asset: Asset) -> Iterator[bytes]:
    """Yield the bytes of all that is drawn and of its materials' numbers."""
    for part in asset.model.parts:
        for field in dataclasses.fields(part.mesh):
            yield getattr(part.mesh, field.name).tobytes()
        yield repr((part.material.name, part.material.base_colour)).encode()
        if part.material.base_colour_texture is not None:
            yield part.material.base_colour_texture.tobytes()
    yield repr((asset.parts, asset.mass_kg, asset.centre_of_mass_m)).encode()


@pytest.fixture(scope="module")
def pieces() -> dict[tuple[str, str], Piece]:
    """Return a piece of each style."""
    return {(family, style): made(family, style, 3) for family, style in STYLES}


SAME = (
    ("chair", "dining"),
    ("wardrobe", "classic"),
    ("sofa", "rolled"),
    ("bed", "drawers"),
    ("kitchen_unit", "corner"),
    ("plant", "tree"),
    ("picture", "row"),
    ("cushion", "striped"),
)


def test_a_seed_gives_the_same_bytes_and_another_seed_others() -> None:
    for family, style in SAME:
        first, again = made(family, style, 17).asset, made(family, style, 17).asset
        assert list(every_array(first)) == list(every_array(again))
        assert list(every_array(first)) != list(every_array(made(family, style, 18).asset))


def test_every_family_has_four_styles_and_categories_of_the_table() -> None:
    known = {category.name for category in load_categories().values()}
    for name in family_names():
        family = family_named(name)
        assert family.name == name
        assert len(family.styles) >= 4
        assert {
            family.category,
            *(s.category or family.category for s in family.styles.values()),
        } <= known


@pytest.mark.parametrize(("family", "style"), STYLES)
def test_a_piece_is_whole(family: str, style: str, pieces: dict[tuple[str, str], Piece]) -> None:
    """Closed meshes, no piece inside out, unit normals, of its size, of known categories."""
    asset = pieces[family, style].asset
    known = {category.name for category in load_categories().values()}
    assert {part.category for part in asset.parts} | {asset.category} <= known
    for part in asset.model.parts:
        mesh = part.mesh
        lengths = np.linalg.norm(mesh.normals.astype(np.float64), axis=1)
        np.testing.assert_allclose(lengths, 1.0, atol=1e-5)
        assert np.isfinite(mesh.uvs).all()
        assert open_edges(mesh.positions, mesh.triangles) == 0
        assert least_volume(mesh.positions, mesh.triangles) > -1e-9
    low, high = asset.model.bounds()
    sizes = family_named(family)
    assert ((high - low >= sizes.least_m) & (high - low <= sizes.most_m)).all()
    assert -0.005 <= low[2] <= 0.02
    assert asset.collision
    assert 0.02 < asset.mass_kg < 600.0
    assert (low <= asset.centre_of_mass_m).all()
    assert (np.asarray(asset.centre_of_mass_m) <= high).all()


@pytest.mark.parametrize(("family", "style"), STYLES)
def test_no_two_materials_lie_in_one_plane(
    family: str, style: str, pieces: dict[tuple[str, str], Piece]
) -> None:
    """Which of two would be seen differs from pixel to pixel, and from renderer to renderer."""
    shared = shared_faces(pieces[family, style].asset.model)
    assert max(shared.values(), default=0.0) < 1e-3


@pytest.mark.parametrize("family", ["floor_lamp", "table_lamp", "ceiling_lamp"])
def test_lamps_glow_by_their_lights(family: str, pieces: dict[tuple[str, str], Piece]) -> None:
    assert all(pieces[family, style].asset.model.is_lamp for style in family_named(family).styles)


@pytest.mark.parametrize("style", list(family_named("mirror").styles))
def test_mirrors_mirror(style: str) -> None:
    """Each shows what stands before it, in one flat face at least."""
    for seed in range(5):
        asset = made("mirror", style, seed).asset
        models = [asset.model, *(part.asset.model for part in asset.moving)]
        things = [Thing(model, Pose((2.0, 0.0, -0.5), (0.0, 0.0, 1.0, 0.0))) for model in models]
        mirrors = [FlatMirrors().seen(snapshot_of([thing]), camera_at()) for thing in things]
        assert any(mirrors)


def open_edges(positions: np.ndarray, triangles: np.ndarray) -> int:
    """Count the directed edges, by places, that have no partner in the other direction."""
    _, place = np.unique(positions.astype(np.float64).round(6), axis=0, return_inverse=True)
    corners = place.reshape(-1)[triangles.astype(np.int64)]
    corners = corners[[len(set(row)) == 3 for row in corners.tolist()]]
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    count = int(place.max()) + 1
    there = dict(
        zip(*np.unique(edges[:, 0] * count + edges[:, 1], return_counts=True), strict=True)
    )
    back = dict(zip(*np.unique(edges[:, 1] * count + edges[:, 0], return_counts=True), strict=True))
    return sum(abs(number - back.get(edge, 0)) for edge, number in there.items())


def least_volume(positions: np.ndarray, triangles: np.ndarray) -> float:
    """Return the least signed volume of connected pieces [m³]: below 0 what is inside out."""
    places = positions.astype(np.float64)
    raw = RawMesh(positions=places, uvs=places[:, :2], triangles=triangles.astype(np.int64))
    corners = places[raw.triangles]
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    return float(np.bincount(components(raw), volumes).min())


def test_what_opens_stands_where_it_is_drawn_in_the_whole(
    pieces: dict[tuple[str, str], Piece],
) -> None:
    """The still body and its moving parts are the whole piece, mesh by mesh."""
    opening = [piece.asset for piece in pieces.values() if piece.asset.moving]
    assert len(opening) >= 9
    for asset in opening:
        assert asset.still is not None
        apart = list(asset.still.model.parts)
        for part in asset.moving:
            apart += part.asset.model.parts
            assert part.asset.opens
            assert part.limits[0] <= 0.0 < part.limits[1]  # where it is drawn
            assert math.isclose(float(np.linalg.norm(part.axis)), 1.0)
        assert {id(one.mesh) for one in apart} == {id(one.mesh) for one in asset.model.parts}
        masses = asset.still.mass_kg + sum(part.asset.mass_kg for part in asset.moving)
        assert masses == pytest.approx(asset.mass_kg, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "at", "low_m", "high_m"),
    [
        ("bowl~salad:0", (0.0, 0.0), 0.005, 0.03),
        ("pot~stock:1", (0.0, 0.0), 0.002, 0.02),
        ("bath~built_in:2", (0.0, 0.3), 0.145, 0.155),
        ("bath~wooden:0", (0.0, 0.0), 0.075, 0.085),
        ("jar~screw:0", (0.0, 0.0), 0.003, 0.007),
    ],
)
def test_what_is_hollow_carries_on_its_floor(
    name: str, at: tuple[float, float], low_m: float, high_m: float
) -> None:
    """A thing that is laid into it lies on the inner floor; on the rim, as high as the rim."""
    asset = LIBRARY.get(name)
    still = asset if asset.still is None else asset.still
    (height,) = support_heights(still, (1.0, 1.0, 1.0), np.array([at]))
    assert low_m <= height <= high_m
    low, high = shape_bounds(still)
    for edge in (high[1], low[1]):
        (rim,) = support_heights(still, (1.0, 1.0, 1.0), np.array([[0.0, 0.99 * edge]]))
        assert rim > 3.0 * height


def shape_bounds(asset: Asset) -> tuple[np.ndarray, np.ndarray]:
    points = shape_points(asset.collision)
    return points.min(axis=0), points.max(axis=0)


OPENING = (
    "wardrobe~hinged:2",
    "wardrobe~sliding:1",
    "wardrobe~classic:5",
    "chest~dresser:0",
    "chest~apothecary:0",
    "sideboard~doors:1",
    "sideboard~sliding:1",
    "sideboard~hutch:1",
    "tv_unit~flaps:0",
    "tv_unit~wall:2",
    "nightstand~door:1",
    "bookcase~cabinet:1",
    "bed~drawers:0",
    "desk~pedestal:2",
    "desk~bureau:0",
    "desk~writing:0",
    "oven~cooker:0",
    "oven~range:1",
    "oven~microwave:2",
    "dishwasher~free:0",
    "dishwasher~integrated:1",
    "kitchen_unit~wall:1",
    "kitchen_unit~corner:2",
    "pot~stock:0",
    "toilet~floor:0",
    "mirror~cabinet:0",
    "mirror~standing:1",
    "clock~tall_case:1",
    "basket~laundry:0",
    "box~chest:1",
    "box~carton:0",
    "bin~pedal:0",
    "bin~swing:1",
    "toilet~wall:1",
    "washbasin~cabinet:0",
    "bath~shower:0",
    "radiator~panel:0",
    "shoe_rack~tipping:1",
    "shoe_rack~closed:0",
    "fridge~combi:1",
    "fridge~french:0",
    "curtain~rings:0",
    "curtain~panels:1",
    "blind~roman:0",
    "blind~vanes:1",
    "blind~shutters:0",
    "folding_screen~slats:1",
    "hood~slanted:0",
    "jar~clip:0",
    "kitchen_machine~toaster:0",
    "kitchen_machine~mixer:1",
    "screen~laptop:0",
    "screen~monitor:1",
    "toy~house:0",
    "towel_rail~arms:0",
    "washing_machine~front:0",
    "washing_machine~top:1",
)
BEHIND = {
    "door": ("tray", "rack", "lower basket", "upper basket", "compartment 1", "compartment 2"),
    "left door": ("left tray", "left rack"),
    "right door": ("right tray", "right rack"),
    "freezer door": tuple(f"freezer compartment {k}" for k in range(1, 6)),
    "lid": ("seat",),
    "front flap": ("left flap", "right flap"),
    "back flap": ("left flap", "right flap"),
}
"""Doors, and what cannot move before they are open."""


def doors_before(part: str) -> tuple[str, ...]:
    """Return the doors that must be open before a part can move."""
    cabinet = re.match(r"cabinet \d ", part)
    prefix = cabinet[0] if cabinet else ""
    name = part.removeprefix(prefix)
    return tuple(prefix + door for door, parts in BEHIND.items() if name in parts)


PENETRATION_M = 0.001
STEPS = 8


def world_of(*objects: Mapping[str, Any]) -> World:
    """Build a world of objects as a scene file has them."""
    spec = SceneSpec.model_validate({"name": "test", "version": 1, "objects": list(objects)})
    return build_world(spec, assets=LIBRARY, categories=load_categories())


def depth_m(world: World, one: Body, other: Body) -> float:
    """Return how deep two bodies stand in one another [m]."""
    points = world.client.getClosestPoints(
        one.bullet_id, other.bullet_id, 0.0, linkIndexA=one.link, linkIndexB=other.link
    )
    return -float(min((point[8] for point in points), default=0.0))


@pytest.mark.parametrize("name", OPENING)
def test_joints_sweep_their_range_without_striking(name: str) -> None:
    """Against the body and all else, shut but for the door before it; poses by arithmetic."""
    asset = LIBRARY.get(name)
    with closing(world_of({"name": "piece", "asset": name, "static": True})) as world:
        bodies = {body.placement.name: body for body in world.bodies}
        assert list(bodies) == ["piece", *(f"piece {part.name}" for part in asset.moving)]
        for part in asset.moving:
            body, number = bodies[f"piece {part.name}"], world.find(f"piece {part.name}")
            assert body.placement.joint is not None
            doors = [one for one in asset.moving if one.name in doors_before(part.name)]
            for door in doors:
                world.set_joint(world.find(f"piece {door.name}"), door.limits[1])
            for position in np.linspace(*part.limits, STEPS).tolist():
                world.set_joint(number, position)
                there = link_pose(Pose(), body.placement.joint, position)
                np.testing.assert_allclose(body.world_from_body(), there.matrix(), atol=1e-12)
                for other in bodies.values():
                    if other is not body:
                        assert depth_m(world, body, other) < PENETRATION_M
            world.set_joint(number, 0.0)
            for door in doors:
                world.set_joint(world.find(f"piece {door.name}"), 0.0)


def test_what_opens_is_an_object_with_a_parent_and_a_handle() -> None:
    with closing(world_of({"name": "it", "asset": "chest~dresser:0", "static": True})) as world:
        named = {drawn.instance.name: drawn for drawn in world.snapshot().contents.instances}
        drawer = named["it drawer 1"].instance
        assert (drawer.category, drawer.asset) == ("drawer", "chest~dresser:0#drawer 1")
        assert drawer.parent == named["it"].instance.id
        handle = named["it drawer 1/handle"].instance
        assert (handle.category, handle.parent) == ("handle", drawer.id)
        for drawn in named.values():
            found = LIBRARY.drawn_model(drawn.instance.asset)
            assert [one.mesh for one in found.parts] == [one.mesh for one in drawn.model.parts]
        # What opens has the light of moving objects, so that the inside is lit as if it were open.
        moving = {f"it {part.name}" for part in LIBRARY.get("chest~dresser:0").moving}
        assert {n for n, d in named.items() if not d.stands and not d.instance.is_part} == moving


@pytest.mark.parametrize(("family", "style"), STYLES)
def test_what_nobody_opens_stays_shut(
    family: str, style: str, pieces: dict[tuple[str, str], Piece]
) -> None:
    """Gravity moves no pedal, flap or chain: a room rests from its first frame on."""
    parts = pieces[family, style].asset.moving
    if not parts:
        return
    piece = {"name": "it", "asset": f"{family}~{style}:3", "static": True}
    with closing(world_of(piece)) as world:
        world.step(240)
        joints = [world.joint(world.find(f"it {part.name}")) for part in parts]
        assert [joint.position for joint in joints if joint is not None] == [0.0] * len(parts)


@pytest.mark.parametrize(
    ("piece", "part", "opened", "ajar", "settled"),
    [
        ("kitchen_unit~modern:3", "cabinet 2 right door", 1.5, 0.4, 0.0),
        ("wardrobe~classic:3", "drawer 1", 0.3, 0.05, 0.0),
        ("wardrobe~classic:3", "left door", 1.5, 0.06, 0.0),
        ("toilet~wall:3", "lid", 1.6, 0.5, 0.0),
        ("oven~cooker:3", "knob 1", 4.0, 0.3, np.pi / 6),
        ("oven~cooker:3", "door", 1.5, 0.06, 0.0),
        ("washbasin~pedestal:3", "lever", 0.6, 0.2, np.pi * 17.5 / 180),
        ("fridge~double:3", "door", 1.5, 0.06, 0.0),
        ("shoe_rack~tipping:3", "flap 1", 0.55, 0.3, 0.0),
        ("blind~shutters:3", "left leaf", 1.5, 0.06, 0.0),
        ("box~chest:3", "lid", 1.6, 0.9, 0.0),
        ("box~trunk:3", "lid", 1.5, 0.9, 0.0),
        ("box~jewels:3", "lid", 1.6, 0.9, 0.0),
        ("bin~pedal:3", "lid", 1.3, 0.9, 0.0),
        ("bin~pedal:3", "pedal", 0.13, 0.1, 0.0),
        ("bin~swing:3", "flap", 0.6, 0.5, 0.0),
        ("toilet~high:3", "pull", 0.05, 0.04, 0.0),
        ("washing_machine~top:3", "lid", 1.3, 0.9, 0.0),
    ],
)
def test_what_opens_shuts_or_clicks_by_itself(
    piece: str, part: str, opened: float, ajar: float, settled: float
) -> None:
    """From shut it opens when it is asked to; let go ajar or between clicks, it settles."""
    with closing(world_of({"name": "it", "asset": piece, "static": True})) as world:
        number = world.find(f"it {part}")

        def place() -> float:
            joint = world.joint(number)
            assert joint is not None
            return joint.position

        world.step(20)
        assert place() == 0.0
        world.set_joint(number, opened, 2.0)
        world.step(485)
        # What clicks goes on to its detent.
        assert place() == pytest.approx(opened, abs=0.3)
        world.set_joint(number, ajar)
        world.step(720)
        assert place() == pytest.approx(settled, abs=1e-3)


def test_a_door_of_a_larger_piece_turns_about_its_own_edge() -> None:
    """What lies on the axis of the piece at scale 1 lies on that of the larger one."""
    name = "wardrobe~hinged:7"
    part = next(one for one in made("wardrobe", "hinged", 7).asset.moving if one.type == "hinge")
    with closing(world_of({"name": "w", "asset": name, "static": True, "scale": 1.5})) as world:
        door = next(body for body in world.bodies if body.placement.name == f"w {part.name}")
        hinge = np.append(1.5 * np.asarray(part.origin_m), 1.0)
        before = door.world_from_body() @ hinge
        world.set_joint(world.find(f"w {part.name}"), 1.0)
        np.testing.assert_allclose(door.world_from_body() @ hinge, before, atol=1e-9)


def test_a_piece_that_moves_freely_keeps_itself_shut() -> None:
    """In one body, whose parts are labelled all the same; nothing is lost of its mass."""
    name = "nightstand~drawers:1"
    with closing(world_of({"name": "it", "asset": name})) as world:
        assert [body.placement.name for body in world.bodies] == ["it"]
        assert world.body(1).mass_kg == pytest.approx(LIBRARY.get(name).mass_kg)
        labels = [drawn.instance.name for drawn in world.snapshot().contents.instances]
        assert "it/drawer 1" in labels
        assert "it/drawer 1/handle" in labels


def test_an_entry_of_its_own_takes_the_place_of_what_opens() -> None:
    """So a scene that was saved is built as it was."""
    name = "nightstand~drawers:1"
    joint = {
        "type": "slide",
        "parent": "it",
        "axis": [1, 0, 0],
        "limits": [0, 0.2],
        "position": 0.1,
    }
    mine = {"name": "my drawer", "asset": f"{name}#drawer 1", "joint": joint}
    count = len(LIBRARY.get(name).moving)
    with closing(world_of({"name": "it", "asset": name, "static": True}, mine)) as world:
        names = [body.placement.name for body in world.bodies]
        assert "my drawer" in names
        assert "it drawer 1" not in names
        assert len(names) == 1 + count


def test_spawned_pieces_open_and_go_with_what_opens(tmp_path: Path) -> None:
    """Saving and building again gives the same joints."""
    empty = tmp_path / "empty.yaml"
    empty.write_text("version: 1\n")
    with Simulation(empty, mode="lockstep", backend="native") as simulation:
        piece = simulation.spawn_object("sideboard~doors:1", (1, 0, 0), object_name="it")
        simulation.set_joint_position("it left door", 1.0)
        saved = tmp_path / "saved.yaml"
        saved.write_text(simulation.scene_text())
        before = [(j.name, j.position) for j in simulation.get_joints()]
        simulation.despawn_object(piece)
        assert simulation.get_joints() == ()
        simulation.change_scene(str(saved))
        assert [(j.name, j.position) for j in simulation.get_joints()] == before


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("chair~dinning:3", "did you mean 'dining'"),
        ("char~dining:3", "did you mean 'chair'"),
        ("chair~dining", "FAMILY~STYLE:SEED"),
        ("chair~dining:-1", "FAMILY~STYLE:SEED"),
        ("chair~dining:99999999999", "FAMILY~STYLE:SEED"),
        ("tv_unit~low:2#top", "moving part of 'tv_unit~low:2'"),
    ],
)
def test_names_are_refused_in_words_and_at_their_place(name: str, why: str, tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match=why):
        LIBRARY.get(name)
    scene = tmp_path / "scene.yaml"
    scene.write_text(f"version: 1\nobjects:\n  - {{name: it, asset: '{name}'}}\n")
    with pytest.raises(SceneError, match=r"scene.yaml:3:\d+: objects\[0\].asset: .*" + why):
        load_scene(
            scene,
            knowledge=SceneKnowledge(
                assets=LIBRARY.all_names, categories=(), behaviour_errors=lambda *_: ()
            ),
        )


def family_of(style: Style) -> Family:
    """Return a family of one style."""
    return Family(
        name="block",
        category="box",
        styles={"plain": style},
        least_m=(0.1, 0.1, 0.1),
        most_m=(1.0, 1.0, 1.0),
    )


def block(b: PieceBuilder, v: Values) -> None:
    """Make a block; a hole may leave nothing of it."""
    if v.hole > v.size / 2:
        raise Unfit("the hole leaves nothing of it")
    b.box(wood("oak"), (v.size, v.size, v.size), (0.0, 0.0, v.size / 2))


NAME = PieceName("block", "plain", 0)


@pytest.mark.parametrize(
    ("parameter", "why"),
    [
        (Span(0.5, 0.4), "'size' is impossible: its least value 0.5 is above its greatest, 0.4"),
        (Span(0.5, math.inf), "must be finite numbers"),
        (Whole(3, 2), "least value 3"),
        (Choice(), "no value to choose from"),
    ],
)
def test_impossible_parameters_are_refused(parameter: object, why: str) -> None:
    style = Style(block, {"size": parameter, "hole": 0.0})
    with pytest.raises(AssetError, match=why):
        make_piece(family_of(style), NAME)


def test_a_draw_that_fails_its_checks_is_drawn_again_and_counted() -> None:
    style = Style(block, {"size": Span(0.05, 0.3), "hole": Span(0.0, 0.2)})
    draws = [make_piece(family_of(style), PieceName("block", "plain", n)) for n in range(20)]
    assert all(piece.draws == len(piece.rejected) + 1 for piece in draws)
    assert max(piece.draws for piece in draws) > 1
    reasons = {reason for piece in draws for reason in piece.rejected}
    assert "the hole leaves nothing of it" in reasons
    assert any("along x" in reason for reason in reasons)
    hopeless = Style(block, {"size": 5.0, "hole": 0.0})
    with pytest.raises(AssetError, match=f"none of {MAX_DRAWS} draws makes a sound piece"):
        make_piece(family_of(hopeless), NAME)
