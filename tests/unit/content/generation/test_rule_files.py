"""Rule files: the package's own are well, and what is wrong is told with its place."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from sailenv_ros.authoring.room_rules.names import asked_for, drawn_kind, file_stem, parsed_name
from sailenv_ros.authoring.room_rules.rule_files import read_rules, room_kinds, rules_of
from sailenv_ros.errors import SceneError, UnknownName
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.system.resources import resource_path

KINDS = ("apartment", "bathroom", "bedroom", "kitchen", "living_room", "office")


def _copy(tmp_path: Path) -> Path:
    return shutil.copytree(resource_path("config", "rooms"), tmp_path / "rooms")


def _changed(folder: Path, file: str, old: str, new: str) -> list[str]:
    path = folder / file
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    known = SceneLibrary().knowledge
    with pytest.raises(SceneError) as caught:
        read_rules(
            folder, assets=known.assets, categories=known.categories, surfaces=known.surfaces,
            skies=known.skies,
        )  # fmt: skip
    return str(caught.value).splitlines()


def test_the_packages_own_rules_are_well() -> None:
    known = SceneLibrary().knowledge
    rules = read_rules(
        resource_path("config", "rooms"),
        assets=known.assets,
        categories=known.categories,
        surfaces=known.surfaces,
        skies=known.skies,
    )
    assert tuple(sorted(rules.kinds)) == room_kinds() == KINDS


@pytest.mark.parametrize(
    ("file", "old", "new", "told"),
    [
        (
            "bedroom.yaml",
            "put: bed,",
            "put: bedd,",
            "there is no piece 'bedd'; did you mean 'bed'?",
        ),
        ("bedroom.yaml", "width: [3.4, 5.0]", "width: [5.0, 3.4]", "must be [least, most]"),
        ("bedroom.yaml", "chance: 0.6", "chance: 6", "must be a number from 0 to 1"),
        ("bedroom.yaml", "title:", "titel:", "is not a key that is known here; did you mean"),
        ("bedroom.yaml", "[warm, ", "[worm, ", "there is no set of materials 'worm'"),
        ("library/furniture.yaml", "[bed_01, ", "[bed_91, ", "there is no asset 'bed_91'"),
        ("library/furniture.yaml", "holds: bed", "holds: bad", "there is no list of things 'bad'"),
        ("library/furniture.yaml", "bed~slatted:*", "bed~slated:*", "did you mean 'slatted'?"),
        ("library/things.yaml", "cup~tumbler:*", "cpu~tumbler:*", "did you mean 'cup'?"),
        ("library/things.yaml", "pillow_02, ", "pilow_02, ", "there is no asset 'pilow_02'"),
        ("library/materials.yaml", "oak_parquet]", "oak_parket]", "there is no material"),
        ("library/light.yaml", "sunrise,", "sunrize,", "there is no sky 'sunrize'"),
        ("apartment.yaml", "kind: kitchen", "kind: kitschen", "there is no kind of room"),
        ("kitchen.yaml", "lacking: stove", "lacking: stofe", "there is no category 'stofe'"),
        ("library/furniture.yaml", "lacking: stove", "lacking: stov", "did you mean 'stove'?"),
        ("library/things.yaml", "[0.8, 1.1]", "[1.1, 0.8]", "must be [least, most]"),
        ("bathroom.yaml", "[vanity]", "[vanty]", "there is no piece 'vanty'"),
        ("apartment.yaml", "name: bedroom, ", "", "is a room and must have a name"),
    ],
)
def test_what_is_wrong_is_told_with_file_line_and_column(
    tmp_path: Path, file: str, old: str, new: str, told: str
) -> None:
    folder = _copy(tmp_path)
    line = (folder / file).read_text().split(old)[0].count("\n") + 1
    told_now = [error for error in _changed(folder, file, old, new) if told in error]
    assert len(told_now) == 1
    path, *_ = told_now[0].split(": ")
    assert path.startswith(f"{folder / file}:")
    assert abs(int(path.split(":")[1]) - line) <= 1


def test_a_piece_that_belongs_to_itself_is_refused(tmp_path: Path) -> None:
    errors = _changed(_copy(tmp_path), "library/furniture.yaml", "put: bed painting,", "put: bed,")
    assert any("leads back to the piece itself" in error for error in errors)


def test_a_kind_is_added_by_a_file_alone(tmp_path: Path) -> None:
    folder = _copy(tmp_path)
    text = (folder / "bedroom.yaml").read_text().replace("title: Bedroom", "title: Cell")
    (folder / "cell.yaml").write_text(text)
    assert read_rules(folder).kind("cell").title == "Cell"


def test_names_of_generated_scenes() -> None:
    rules = rules_of()
    assert parsed_name("generated:kitchen:17", rules) == ("kitchen", 17)
    for wrong in (
        *("", ":", "kitchen", "kitchen:-1", "a:b:c", "kitchen:1.5", "kitchen:1e3", "kitchen:0x1"),
        *("kitchen: 1", "kitchen:1\n", "kitchen:١٧", "KITCHEN:1", "🛋:1", "../kitchen:1", ":1"),
        *(f"kitchen:{'9' * 40}", f"{'k' * 1000}:1", "kitchen:1/../../x", "kitchen\0:1"),
    ):
        with pytest.raises(ValueError, match="generated:KIND:SEED"):
            parsed_name(f"generated:{wrong}", rules)
    with pytest.raises(UnknownName, match="did you mean 'kitchen'"):
        parsed_name("generated:kitchn:1", rules)


def test_a_generated_scene_is_asked_for_again_by_its_kind_and_seed() -> None:
    """From the name of its file, which has neither colons nor anything else to escape."""
    for kind in KINDS:
        assert asked_for(file_stem(kind, 17)) == f"generated:{kind}:17"
    assert asked_for("room_01") == "room_01"


def test_a_seed_stands_for_a_kind_where_none_is_asked_for() -> None:
    rules = rules_of()
    drawn = [drawn_kind(seed, rules) for seed in range(60)]
    assert set(drawn) == set(KINDS)
    assert drawn == [drawn_kind(seed, rules) for seed in range(60)]
