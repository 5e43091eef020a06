"""Hypothesis strategies for scenes, as the plain data that a file holds."""

from __future__ import annotations

from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

unhurried = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
"""A busy machine is no error of the code under test."""

Entries = st.SearchStrategy[dict[str, Any]]

metres = st.floats(-100, 100)
positions = st.tuples(metres, metres, metres).map(list)
angles = st.tuples(*[st.floats(-360, 360)] * 3).map(list)
fractions = st.floats(0, 1)
colours = st.from_regex(r"#[0-9a-f]{6}", fullmatch=True) | st.tuples(*[fractions] * 3).map(list)
# Names that YAML could take for something else are the interesting ones.
names = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9 _.-]{0,10}", fullmatch=True) | st.sampled_from(
    ["1e3", "007", "null", "true", "yes", "1.5", "1 - 2", "0x1F", "1_0"]
)
titles = st.text(st.characters(exclude_categories=["Cs", "Cc", "Cn"]), max_size=40)


def _name(entry: dict[str, Any]) -> str:
    return str(entry["name"])


def some(**optional: st.SearchStrategy[Any]) -> st.SearchStrategy[dict[str, Any]]:
    """Any of these keys."""
    return st.fixed_dictionaries({}, optional=optional)


def _merged(parts: tuple[dict[str, Any], ...]) -> dict[str, Any]:
    return {key: value for part in parts for key, value in part.items()}


turns = some(rotation=angles) | st.just({"orientation": [0.5, -0.5, 0.5, 0.5]})

behaviours: Entries = st.fixed_dictionaries(
    {"type": st.just("spin")},
    optional={"rate": st.integers(), "words": st.lists(names, max_size=2)},
)

objects: Entries = st.tuples(
    st.fixed_dictionaries({"name": names, "asset": st.sampled_from(["cube", "Chair 01"])}),
    turns,
    some(
        position=positions,
        scale=st.floats(0.01, 10) | st.tuples(*[st.floats(0.01, 10)] * 3).map(list),
        mass=st.none() | st.floats(1e-6, 1e6),
        gravity=st.booleans(),
        friction=st.floats(0, 10),
        restitution=fractions,
        category=st.sampled_from([None, "chair", "dining table"]),
        colour=st.none() | colours,
        metallic=fractions,
        velocity=positions,
        behaviours=st.lists(behaviours, max_size=2),
    ),
).map(_merged)

lights: Entries = st.tuples(
    st.fixed_dictionaries({"name": names, "type": st.sampled_from(["point", "spot"])}),
    some(colour=colours, intensity=st.floats(0, 1e5), position=positions),
).map(_merged)

waypoints: Entries = st.tuples(
    st.fixed_dictionaries({"position": positions}), turns | st.just({"look_at": [500.0, 0.0, 0.0]})
).map(_merged)

bodies = some(
    mass=st.floats(0.001, 1000),
    drag=st.floats(0, 1000),
    restitution=st.floats(0, 1),
    gravity=st.booleans(),
    velocity=positions,
)

surfaces = st.sampled_from(["plaster", "oak_planks"]) | some(
    material=st.just("white_tiles"),
    colour=st.none() | colours,
    seed=st.integers(0, 99),
    turn=st.floats(-360, 360),
)

# Openings that fit every room of this size, each in a wall of its own.
windows: Entries = st.tuples(
    st.fixed_dictionaries({"type": st.just("window"), "wall": st.sampled_from(["north", "east"])}),
    some(
        at=st.floats(-0.5, 0.5),
        width=st.floats(0.3, 2.0),
        height=st.floats(0.3, 1.2),
        casements=st.none() | st.integers(1, 3),
        curtains=st.booleans() | some(colour=colours, drawn=st.floats(0, 0.9)),
    ),
).map(_merged)
doors: Entries = st.tuples(
    st.fixed_dictionaries({"type": st.just("door"), "wall": st.sampled_from(["south", "west"])}),
    some(open=st.floats(0, 170), hinge=st.sampled_from(["left", "right"]), colour=colours),
).map(_merged)

rooms: Entries = st.tuples(
    st.fixed_dictionaries({"size": st.just([4.4, 3.6, 2.6])}),
    some(
        thickness=st.floats(0.15, 0.5),
        walls=surfaces,
        wall_materials=some(north=surfaces, west=surfaces),
        floor=surfaces,
        ceiling=st.booleans() | surfaces,
        skirting=st.booleans() | some(height=st.floats(0.02, 0.3), colour=colours),
        openings=st.lists(windows | doors, max_size=3, unique_by=lambda entry: entry["wall"]),
    ),
).map(_merged)

scenes: Entries = st.fixed_dictionaries(
    {"version": st.just(1)},
    optional={
        "title": titles,
        "gravity": positions,
        "environment": some(ambient=colours, exposure=st.floats(-20, 20)),
        "lights": st.lists(lights, max_size=3, unique_by=_name),
        "room": rooms,
        "objects": st.lists(objects, max_size=3, unique_by=_name),
        "mover": some(waypoints=st.lists(waypoints, max_size=3), total_time=st.floats(0.1, 1e4))
        | some(position=positions, body=bodies),
    },
)
