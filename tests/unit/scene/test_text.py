"""Text that is no proper YAML, or hostile, is refused with its place and costs little."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from sailenv_ros.scene import yaml_nodes
from tests.unit.scene.reading import diagnostics

TEXTS = {
    "empty": ("", "1:1: is empty; a scene is a mapping (key: value)"),
    "comment only": ("# nothing\n", "1:1: is empty; a scene is a mapping (key: value)"),
    "a list at the top": (
        "- 1\n",
        "1:1: must be a mapping (key: value) at its top, got [1]",
    ),
    "duplicate key": (
        "version: 1\ntitle: a\ntitle: b\n",
        "3:1: the key 'title' stands in line 2 already",
    ),
    "tag": (
        "version: 1\ntitle: !!python/object/apply:os.system ['true']\n",
        "2:8: tags such as tag:yaml.org,2002:python/object/apply:os are not accepted; leave it out",
    ),
    "merge key": (
        "version: 1\nmover: {<<: {}}\n",
        "2:9: merge keys (<<) are not accepted; write the keys out",
    ),
    "a key that is a list": ("version: 1\n? [a]\n: 1\n", "2:3: a key must be a word"),
    "second document": (
        "version: 1\n---\nversion: 1\n",
        "2:1: starts a second document; a file holds one",
    ),
    "unknown alias": ("version: 1\ntitle: *t\n", "2:8: *t refers to nothing that stands before it"),
    "recursive alias": (
        "version: 1\nlights: &l [*l]\n",
        "2:13: *l refers to itself",
    ),
    "not UTF-8": (b"version: 1\ntitle: \xff\n", "2:8: is not UTF-8 text: byte 0xff"),
    "nested too deep": (
        "version: 1\nlights: " + "[" * 100 + "]" * 100,
        "2:41: is nested deeper than 32 levels",
    ),
}


@pytest.mark.parametrize(("text", "first"), TEXTS.values(), ids=TEXTS)
def test_a_text_that_is_refused(tmp_path: Path, text: str | bytes, first: str) -> None:
    told = diagnostics(tmp_path, text)
    assert first in told


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("version: 1\nlights: [\n", "3:1: "),
        ("version: 1\n\ttitle: x\n", "2:1: "),
        ("version: 1\n title: x\n", "2:7: "),
        ("version: 1\ntitle: 'x\n", "3:1: "),
        ("version: 1\ntitle: @x\n", "2:8: "),
    ],
)
def test_a_syntax_fault_has_its_place(tmp_path: Path, text: str, place: str) -> None:
    told = diagnostics(tmp_path, text)
    assert len(told) == 1
    assert told[0].startswith(f"{place}is not YAML: ")


def test_tabs_are_named_as_the_culprit(tmp_path: Path) -> None:
    (told,) = diagnostics(tmp_path, "version: 1\nmover:\n\tloop: true\n")
    assert told.endswith("(indent with spaces, not tabs)")


def test_a_control_character_is_refused(tmp_path: Path) -> None:
    (told,) = diagnostics(tmp_path, "version: 1\ntitle: a\x07b\n")
    assert "is not YAML: " in told


def test_an_alias_bomb_is_refused_before_it_is_written_out(tmp_path: Path) -> None:
    lines = ["version: 1", "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    for before, after in zip("abcdefghi", "bcdefghij", strict=True):
        lines.append(f"{after}: &{after} [{', '.join(['*' + before] * 10)}]")
    told = diagnostics(tmp_path, "\n".join(lines))
    assert told == ["7:4: the file stands for more than 200000 values"]


def test_a_file_that_is_too_large_is_not_parsed(tmp_path: Path) -> None:
    (told,) = diagnostics(tmp_path, b"#" * 4_000_001)
    assert told.endswith("is larger than the 4 MB that a scene may have")


def test_anchors_of_an_honest_size_may_be_used(tmp_path: Path) -> None:
    text = "version: 1\nobjects:\n  - {name: a, asset: cube, position: &p [1, 2, 3]}\n"
    assert diagnostics(tmp_path, text + "  - {name: b, asset: cube, position: *p}\n") == []


def test_a_fault_behind_an_alias_is_told_where_the_value_stands(tmp_path: Path) -> None:
    text = "version: 1\nmover: {position: &p [1, 2, x]}\nagents: [{name: a, position: *p}]\n"
    assert [line[:5] for line in diagnostics(tmp_path, text)] == ["2:29:", "2:29:"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e3", 1000.0),
        ("-2.5E-2", -0.025),
        (".5", 0.5),
        ("5.", 5.0),
        ("007", 7),
        ("1:30", "1:30"),
        ("1_000", "1_000"),
        ("0x10", "0x10"),
        ("yes", "yes"),
        ("on", "on"),
        ("true", True),
        ("~", None),
        ("", None),
        ("2026-01-01", "2026-01-01"),
    ],
)
def test_plain_words_mean_what_yaml_1_2_says(text: str, value: object) -> None:
    result = yaml_nodes.plain_scalar(text)
    assert result == value
    assert type(result) is type(value)


def test_both_parsers_of_pyyaml_give_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not every build of PyYAML has libyaml."""
    text = "version: 1\nobjects:\n  - {name: 'a', asset: cube, colour: \"#ff0000\"}\n"
    fast, _ = yaml_nodes.compose(text)
    monkeypatch.setattr(yaml, "CSafeLoader", yaml.SafeLoader)
    slow, _ = yaml_nodes.compose(text)
    assert fast == slow
