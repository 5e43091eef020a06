"""The light of rooms is chosen by the same words at every door."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, get_args

import pytest

from sailenv_ros.cli.main import command_parser, main
from sailenv_ros.dataset import RecipeError, load_recipe
from sailenv_ros.dataset.streams.making import StreamJob
from sailenv_ros.dataset.streams.table import STREAMS
from sailenv_ros.errors import UnknownName
from sailenv_ros.ros.nodes.parameter_table import PARAMETERS
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.background_build import furnishing
from sailenv_ros.types.light_choice import LIGHTS, STEADY_LIGHTS, LightChoice, SteadyLight
from tests.unit.dataset.conftest import written_recipe

SHOW = {
    "run": ["run"],
    "scene render": ["scene", "render", "optical", "-o", "picture.png"],
}
WRITE = {
    "record": ["record", "-o", "bag", "--lockstep"],
    "stream": ["stream", "solid", "-o", "stream"],
    "setup": ["setup"],
}


def words_of(command: list[str]) -> dict[str, bool]:
    """Return which words a command takes."""
    taken = {}
    for word in (*LIGHTS, "bright"):
        try:
            args = command_parser(command).parse_args([*command, "--light", word])
        except SystemExit:
            taken[word] = False
        else:
            taken[word] = args.light == word
    return taken


@pytest.mark.parametrize("name", [*SHOW, *WRITE])
def test_a_command_takes_the_words(name: str) -> None:
    """What only shows takes all; what writes files takes those that always mean the same."""
    accepted = LIGHTS if name in SHOW else STEADY_LIGHTS
    command = {**SHOW, **WRITE}[name]
    assert words_of(command) == {word: word in accepted for word in (*LIGHTS, "bright")}
    default = command_parser(command).parse_args(command).light
    assert default == ("newest" if name in SHOW else "plain" if name == "stream" else "baked")


def test_programs_recipes_and_parameters_take_the_same(tmp_path: Path) -> None:
    """And refuse others before anything is begun."""
    assert set(get_args(SteadyLight)) == set(STEADY_LIGHTS)
    assert set(LIGHTS) == {"newest", *STEADY_LIGHTS}
    assert (PARAMETERS["light"].choices, PARAMETERS["light"].default) == (LIGHTS, "newest")
    with pytest.raises(UnknownName, match="light must be one of: newest, baked, plain, got 'brigh"):
        Simulation("optical", light="bright")  # type: ignore[arg-type]
    for word in (*LIGHTS, "bright"):
        recipe = written_recipe(tmp_path, light=word)
        kind: Any = next(iter(STREAMS.values()))
        if word in STEADY_LIGHTS:
            assert load_recipe(recipe).light == word
            assert StreamJob(kind=kind, frames=2, light=word).light == word
        else:
            with pytest.raises(RecipeError, match="baked, plain"):
                load_recipe(recipe)
            with pytest.raises(UnknownName, match="light must be one of: baked, plain"):
                StreamJob(kind=kind, frames=2, light=word)


@pytest.mark.parametrize("word", LIGHTS)
def test_run_hands_the_word_on(word: LightChoice, monkeypatch: pytest.MonkeyPatch) -> None:
    """To the node, or to the simulation; what would not be shown is not baked."""

    class Begun(Exception):
        pass

    def begin(*words: object, **keys: object) -> None:
        raise Begun(words, keys)

    monkeypatch.setattr(os, "execv", begin)
    monkeypatch.setattr("sailenv_ros.cli.run.Simulation", begin)
    with pytest.raises(Begun) as node:
        main(["run", "optical", "--light", word])
    assert f"light:={word}" in node.value.args[0][1]
    with pytest.raises(Begun) as alone:
        main(["run", "optical", "--light", word, "--no-ros"])
    assert alone.value.args[1]["light"] == word
    step = furnishing("optical", everything=False, light=word != "plain")
    assert (step.command[-2:] == ("--light", "plain")) == (word == "plain")


def test_the_old_word_of_setup_is_still_known() -> None:
    """It was promised by the installation page."""
    arguments = ["setup", "--no-light"]
    assert command_parser(arguments).parse_args(arguments).light == "plain"
