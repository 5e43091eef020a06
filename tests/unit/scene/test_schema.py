"""The exported JSON Schema accepts what the loader accepts, and is not stale."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from hypothesis import given
from pydantic import BaseModel

from sailenv_ros.behaviours import behaviour_kinds
from sailenv_ros.scene import SceneCatalogue, reference
from sailenv_ros.scene.schema import SCHEMA_FILE, is_stale, scene_schema, schema_text
from sailenv_ros.scene.yaml_nodes import compose
from tests.unit.scene.strategies import scenes, unhurried
from tests.unit.scene.test_scene_diagnostics import HEAD, VALUES

BEHAVIOURS = {name: kind.parameters for name, kind in behaviour_kinds().items()}
OWN_FOLDER = SceneCatalogue().folders[-1]


class _Spin(BaseModel):
    rate: int = 0
    words: list[str] = []


class _Inner(BaseModel):
    speed: float


class _Nested(BaseModel):
    inner: _Inner


def _validator(behaviours: dict[str, type[BaseModel]]) -> jsonschema.Draft7Validator:
    return jsonschema.Draft7Validator(scene_schema(behaviours))


def test_the_file_beside_the_scenes_is_not_stale() -> None:
    """Else: run ``sailenv scene schema``."""
    assert not is_stale(OWN_FOLDER / SCHEMA_FILE, BEHAVIOURS)


def test_staleness_is_noticed(tmp_path: Any) -> None:
    path = tmp_path / SCHEMA_FILE
    assert is_stale(path, BEHAVIOURS)
    path.write_text(schema_text(BEHAVIOURS), encoding="utf-8")
    assert not is_stale(path, BEHAVIOURS)
    assert is_stale(path, {})


def test_the_schema_is_a_schema() -> None:
    jsonschema.Draft7Validator.check_schema(scene_schema(BEHAVIOURS))


def test_the_package_s_scenes_fit_it() -> None:
    validator, faults = _validator(BEHAVIOURS), {}
    for name in SceneCatalogue().names:
        # Not PyYAML's own reader: to it, the key `on` is true (YAML 1.1).
        node, diagnostics = compose(SceneCatalogue().path(name).read_text(encoding="utf-8"))
        assert node is not None
        assert not diagnostics
        if found := [error.message for error in validator.iter_errors(node.plain())]:
            faults[name] = found
    assert faults == {}


@pytest.fixture(scope="module")
def spin_validator() -> jsonschema.Draft7Validator:
    """The schema with one behaviour, made once for all examples."""
    return _validator({"spin": _Spin})


@unhurried
@given(data=scenes)
def test_what_the_loader_accepts_fits_it(
    spin_validator: jsonschema.Draft7Validator, data: dict[str, Any]
) -> None:
    spin_validator.validate(data)


BEYOND_A_SCHEMA = {
    # It cannot compare entries, know what assets there are, or tell YAML's NaN from a number.
    "NaN inside a vector",
    "quaternion that is not of unit length",
    "two rotations",
    "behaviour on a static object",
    "velocity of a static object",
    "unknown asset",
    "unknown category",
    "the background is no category of objects",
    "two objects of one name",
    "soft close without limits",
    "detents nowhere",
    "detents by two keys",
    "a single detent without reach",
    "a detent beyond the limits",
    "detents of which none is within the limits",
    "detents of what is fixed",
}


@pytest.mark.parametrize("case", [case for case in VALUES if case not in BEYOND_A_SCHEMA])
def test_what_the_loader_refuses_does_not_fit_it(case: str) -> None:
    data = yaml.safe_load(HEAD + VALUES[case][0].replace("yes", "'yes'"))
    assert not _validator({"spin": _Spin}).is_valid(data)


def test_behaviours_bring_their_parameters_along() -> None:
    validator = _validator({"spin": _Spin, "nested": _Nested})

    def scene(**behaviour: Any) -> dict[str, Any]:
        return {"version": 1, "objects": [{"name": "a", "asset": "a", "behaviours": [behaviour]}]}

    assert validator.is_valid(scene(type="nested", inner={"speed": 1}))
    assert not validator.is_valid(scene(type="nested", inner={"speed": "fast"}))
    assert not validator.is_valid(scene(type="nested"))
    assert not validator.is_valid(scene(type="spin", rate="fast"))


def _properties(schema: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(schema, list):
        schema = dict(enumerate(schema))
    if isinstance(schema, dict):
        properties = schema.get("properties", {})
        if isinstance(properties, dict) and "if" not in properties:
            yield from properties.items()
        for key, value in schema.items():
            if key != "if":
                yield from _properties(value)


def test_every_key_is_described() -> None:
    """Editors and the documentation show these words."""
    keys = list(_properties(scene_schema(BEHAVIOURS)))
    assert len(keys) > 50
    constants = [name for name, entry in keys if "const" in entry]
    assert set(constants) == {"type"}
    assert [
        name for name, entry in keys if "const" not in entry and not entry.get("description")
    ] == []


def test_the_text_is_json_in_the_order_of_the_models() -> None:
    schema = json.loads(schema_text(BEHAVIOURS))
    assert list(schema["properties"])[:3] == ["version", "name", "title"]


def test_the_reference_tables_are_not_stale() -> None:
    """Documentation of every key is written by the command that writes the schema."""
    docs = Path(__file__).parents[3] / "docs"
    assert not reference.is_stale(docs, scene_schema(BEHAVIOURS))


def test_the_reference_tables_have_every_key_of_every_kind() -> None:
    """Kinds, and the keys of each with those of the table that it shares; no others."""
    docs = Path(__file__).parents[3] / "docs"
    schema = scene_schema(BEHAVIOURS)
    tables = {
        title: set(re.findall(r"^\|`(\w+)`\|", text, re.MULTILINE))
        for page in reference.PAGES
        for title, text in re.findall(
            r"^### (.+?)$(.*?)(?=^### |\Z)",
            (docs / page).read_text().partition(reference.MARKER)[2],
            re.MULTILINE | re.DOTALL,
        )
    }
    kinds = {name: title for page in reference.PAGES.values() for name, title in page.items()}
    behaviours = {
        case["then"]["properties"]["type"]["const"]: case["then"]
        for case in schema["$defs"]["BehaviourSpec"]["allOf"]
    }
    assert behaviours.keys() == BEHAVIOURS.keys()
    titles = set(kinds.values())
    for name in behaviours:
        (kinds[name],) = (title for title in titles if name in title.split(", "))
    described = {name: kind for name, kind in schema["$defs"].items() if kind.get("properties")}
    described |= behaviours
    assert described.keys() | {"", "_camera", "_light", "_random", "_behaviour"} == kinds.keys()
    cameras = dict.fromkeys(("AgentSpecModel", "RigCameraSpec"), "Every camera")
    shared = {
        **cameras,
        "Light": "Every light",
        "Random": "Every entry",
        "MaterialSpec": "A surface",
    }
    for name, kind in described.items():
        keys = {
            key
            for key, entry in kind["properties"].items()
            # Those are told in a line above the table.
            if "const" not in entry and not (key == "every" and "enum" in entry)
        }
        family = next((title for word, title in shared.items() if word in name), None)
        family = "Every behaviour" if name in behaviours else family
        also = tables[family] if family else set()
        assert tables[kinds[name]] | also == keys, name
    assert tables["The scene"] == set(schema["properties"])
