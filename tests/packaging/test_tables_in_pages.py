"""Tables of the pages have the names that the code has, and no others.

Tables of topics, services and parameters are compared with a running node in `tests/ros`, those of
scene files with the schema in `tests/unit/scene`.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator

import pytest
from pydantic import BaseModel

from sailenv_ros import AgentSpec, Simulation
from sailenv_ros.dataset import recipe_cameras
from sailenv_ros.dataset.formats import FORMATS
from sailenv_ros.dataset.recipe import (
    AnnotationRecipe,
    ClipRecipe,
    DatasetRecipe,
    SceneRecipe,
)
from sailenv_ros.frame.motion import Motion, Tracks
from tests.packaging.project import ROOT

NAME = re.compile(r"`([a-z_A-Z]\w*)`")
FORMAT = re.compile(r"`(\w[\w-]*)`")


def rows(page: str, heading: str) -> list[tuple[str, str]]:
    """Return the first cell of each row of the tables below a heading, and the rest of the row."""
    text = (ROOT / "docs" / page).read_text()
    section = re.split(r"\n#+ ", text.split(f"# {heading}\n")[1])[0]
    found = re.findall(r"^\|([^|]*)\|(.*)$", section, re.MULTILINE)
    return [(first, rest) for first, rest in found if not re.fullmatch(r"[ :-]+", first)]


def names(page: str, heading: str, pattern: re.Pattern[str] = NAME) -> set[str]:
    """Return the names in the first cells."""
    return {name for first, _ in rows(page, heading) for name in pattern.findall(first)}


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    with Simulation("optical", mode="lockstep", agent=AgentSpec(name="eye")) as simulation:
        yield simulation


@pytest.mark.gl
def test_keys_of_the_agents_frame(simulation: Simulation) -> None:
    assert names("agent.md", "The Agent's frame") == set(simulation.get_frame())


@pytest.mark.gl
def test_columns_of_the_table_of_objects(simulation: Simulation) -> None:
    table = simulation.capture().objects
    columns = set(next(iter(table.rows()))) | {"visible_share", "truncated_share"}
    assert names("objects.md", "The table") == columns


def test_arrays_of_motion_and_tracks() -> None:
    fields = {field.name for field in dataclasses.fields(Motion)} | {"visible"}
    assert names("motion.md", "Between two frames") == fields
    given = {"instances", "coords"}  # by the points that are followed
    assert names("motion.md", "Tracks") == {f.name for f in dataclasses.fields(Tracks)} - given


def test_keys_of_recipes_and_of_their_parts() -> None:
    """Each part's keys stand in the row of the key that holds it."""
    told = {name: rest for first, rest in rows("datasets.md", "What a recipe says")
            for name in NAME.findall(first)}  # fmt: skip
    cameras: dict[str, type[BaseModel]] = {
        name.removesuffix("Camera").lower(): kind
        for name, kind in vars(recipe_cameras).items()
        if name.endswith("Camera") and "type" in getattr(kind, "model_fields", {})
    }
    assert told.keys() == DatasetRecipe.model_fields.keys() | cameras.keys()
    parts: dict[str, type[BaseModel]] = {
        "scenes": SceneRecipe,
        "clip": ClipRecipe,
        "annotations": AnnotationRecipe,
    }
    for name, part in parts.items():
        words = set(re.findall(r"\w+", told[name]))
        assert part.model_fields.keys() - words == set(), name
    page = (ROOT / "docs" / "datasets.md").read_text()
    common = re.search(r"Cameras have (.*) and a `type`", page)
    assert common is not None
    for name, camera in cameras.items():
        words = set(re.findall(r"\w+", told[name] + common[1])) | {"type"}
        assert camera.model_fields.keys() - words == set(), name


def test_formats_of_data_sets() -> None:
    """All of them; of a film of the views there is nothing to compare."""
    told = names("recording.md", "Formats", FORMAT) | names("datasets.md", "Reading", FORMAT)
    assert told == FORMATS.keys()
    assert names("training.md", "Which format holds what", FORMAT) == FORMATS.keys() - {"mp4"}
