"""What is written is read back equal; what is broken gives `SceneError` and nothing else."""

from __future__ import annotations

import json
import string
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import SceneError
from sailenv_ros.scene import SceneSpec
from sailenv_ros.scene.dumper import dump_scene
from tests.unit.scene.reading import read
from tests.unit.scene.strategies import scenes, unhurried


@unhurried
@given(scenes)
def test_a_scene_that_is_dumped_loads_equal(tmp_path_factory: Any, data: dict[str, Any]) -> None:
    spec = SceneSpec.model_validate({**data, "name": "room"})
    assert read(tmp_path_factory.getbasetemp(), dump_scene(spec)) == spec


@unhurried
@given(scenes)
def test_a_file_and_its_data_give_the_same_scene(
    tmp_path_factory: Any, data: dict[str, Any]
) -> None:
    """Reading neither adds nor loses anything; JSON is YAML that another writer made."""
    text = json.dumps(data, ensure_ascii=False)
    assert read(tmp_path_factory.getbasetemp(), text) == SceneSpec.model_validate(
        {**data, "name": "room"}
    )


def _refused_or_read(folder: Path, content: bytes) -> None:
    try:
        read(folder, content)
    except SceneError as error:
        told = error.diagnostics
    else:
        return
    assert told
    for diagnostic in told:
        assert diagnostic.message
        assert "\n" not in str(diagnostic)


@unhurried
@given(st.binary(max_size=300))
def test_arbitrary_bytes_give_a_scene_error(tmp_path_factory: Any, content: bytes) -> None:
    _refused_or_read(tmp_path_factory.getbasetemp(), content)


@unhurried
@given(st.text(string.printable, max_size=300))
def test_arbitrary_text_gives_a_scene_error(tmp_path_factory: Any, content: str) -> None:
    _refused_or_read(tmp_path_factory.getbasetemp(), content.encode())


_WORDS = """
version name objects lights mover movers waypoints behaviours type spin asset cube point position
rotation orientation look_at direction static categories agents views rgb id
"""
_words = st.sampled_from(_WORDS.split())
_scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=True, allow_infinity=True)
    | st.text(max_size=8)
    | _words
)
_values: st.SearchStrategy[Any] = st.recursive(
    _scalars,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(_words, inner, max_size=5),
    max_leaves=30,
)


@unhurried
@given(st.dictionaries(_words, _values, max_size=8))
def test_any_structure_of_known_words_gives_a_scene_or_a_scene_error(
    tmp_path_factory: Any, data: dict[str, Any]
) -> None:
    """Rules between keys must bear any value in any place."""
    content = yaml.safe_dump({"version": 1, **data}, allow_unicode=True).encode()
    _refused_or_read(tmp_path_factory.getbasetemp(), content)


@unhurried
@given(scenes, st.data())
def test_one_wrong_value_in_a_good_scene_is_told_where_it_stands(
    tmp_path_factory: Any, data: dict[str, Any], drawn: st.DataObject
) -> None:
    key = drawn.draw(st.sampled_from(["gravity", "objects", "title", "environment", "mover"]))
    text = yaml.safe_dump({**data, key: ...} | {key: True}, sort_keys=False)
    line = next(i for i, row in enumerate(text.splitlines(), 1) if row.startswith(f"{key}:"))
    with pytest.raises(SceneError) as caught:
        read(tmp_path_factory.getbasetemp(), text)
    found = [(f.line, f.column) for f in caught.value.diagnostics if f.field == key]
    assert found == [(line, len(key) + 3)]
