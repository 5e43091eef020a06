"""Every line for a shell that a page shows can be typed: its program, files and options exist.

Lines of `sailenv` are parsed by its parser, and what is cheap is run; nothing is installed.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest

from sailenv_ros.cli.main import command_parser, main
from sailenv_ros.errors import SceneError
from sailenv_ros.ros.nodes.parameter_table import PARAMETERS
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.simulation.scenes import SceneLibrary
from tests.packaging.pages import LANGUAGES, PAGES, blocks, sailenv_words, shell_lines
from tests.packaging.project import ROOT
from tests.support.faults import faults_of

LINES = shell_lines()

SETUP = (ROOT / "setup.py").read_text()
OTHERS = {"docker", "export", "jupyter", "ray", "rviz2", "source", "ssh"}
"""Programs of others; of their arguments only paths in this repository are looked at."""


def script(words: list[str]) -> None:
    """A script of the repository, which can be executed."""
    name = words[0].removeprefix("src/sailenv_ros/")
    assert os.access(ROOT / name, os.X_OK)


def sailenv(words: list[str]) -> None:
    """Its parser takes the line."""
    words = sailenv_words(words[1:])
    assert command_parser(words).parse_args(words).command == words[0]


def ros2(words: list[str]) -> None:
    """Nodes are installed, launch files exist, parameters are declared."""
    verb = words[1]
    if verb == "run":
        assert words[2] == "sailenv_ros"
        assert f'"{words[3]} = ' in SETUP
        given = re.findall(r"([\w.]+):=", " ".join(words[4:]))
        declared = set(PARAMETERS) | {"__ns", "input"}
        assert set(given) <= declared
    elif verb == "launch":
        assert (ROOT / "launch" / words[3]).is_file()
    else:
        assert verb in {"topic", "service", "security", "bag", "param"}


def python(words: list[str]) -> None:
    """The file or module exists, and knows the options."""
    if words[1] == "-m":
        if words[2] in {"venv", "colcon"}:
            return
        found = find_spec(words[2])
        assert found is not None
        path = Path(str(found.origin))
    else:
        path = ROOT / words[1]
        if words[1] == "my_program.py":
            return
    source = path.read_text()
    for option in words[2:]:
        if option == "--":
            break
        if option.startswith("--"):
            assert f'"{option}"' in source, option


def pip(words: list[str]) -> None:
    """Extras of this package are declared."""
    assert words[1] == "install"
    named = re.findall(r"(?:sailenv_ros|\.)\[([\w,]+)\]", " ".join(words))
    for extra in ",".join(named).split(","):
        assert not extra or f'"{extra}"' in SETUP, extra


def other(words: list[str]) -> None:
    """What it names in this repository exists."""
    for word in words[1:]:
        if re.match(r"(config|examples|scripts|scenes|docs)/", word):
            assert (ROOT / word).exists(), word


PROGRAMS: dict[str, Callable[[list[str]], None]] = {
    "sailenv": sailenv,
    "ros2": ros2,
    "python": python,
    "python3": python,
    "pip": pip,
    **dict.fromkeys(OTHERS, other),
}


def test_lines_for_a_shell_can_be_typed() -> None:
    assert faults_of(can_be_typed, LINES) == {}


def can_be_typed(words: list[str]) -> None:
    """A script of the repository, or a line of a program that is known."""
    name = words[0].rpartition("/")[2]
    if re.match(r"(src/sailenv_ros/)?scripts/", words[0]):
        script(words)
    else:
        PROGRAMS[name](words)


OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")
ELSEWHERE = {"--no-deps", "--require-hashes", "--ros-args", "--shm-size"}
"""Options of programs of others."""


def options_in_sentences(page: Path) -> set[str]:
    """Return the options that a page names between backticks, outside of its blocks."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    return {option for code in re.findall(r"`([^`]*)`", text) for option in OPTION.findall(code)}


def test_options_in_sentences_are_known_to_some_program() -> None:
    """To a command, a benchmark or a script of the repository, or to a program of others."""
    folders = ("sailenv_ros/cli", "sailenv_bench", "benchmarks", "scripts", "tests/support")
    files = [file for folder in folders for file in (ROOT / folder).rglob("*") if file.is_file()]
    texts = [file.read_text() for file in files if file.suffix in (".py", "")]
    known = {option for text in texts for option in OPTION.findall(text)} | ELSEWHERE
    named = {page.name: options_in_sentences(page) - known for page in PAGES}
    assert {page: options for page, options in named.items() if options} == {}


@pytest.mark.parametrize("command", ["record", "export", "play"])
def test_the_page_on_recording_has_every_option(command: str) -> None:
    """Of the three commands; `-o` stands for its long name."""
    shown = options_in_sentences(ROOT / "docs" / "recording.md") | {"--help", "--output"}
    help_of = command_parser([command])
    action = help_of._subparsers._group_actions[0]  # type: ignore[union-attr]  # argparse keeps them private
    assert set(OPTION.findall(action.choices[command].format_usage())) - shown == set()  # type: ignore[index]


def test_there_are_lines_of_each_kind() -> None:
    """The test above has something to look at."""
    names = {words[0].rpartition("/")[2] for words in LINES.values()}
    assert len(LINES) > 80
    assert names >= {"sailenv", "ros2", "python", "pip", "run", "setup"}


def test_every_block_says_its_language() -> None:
    """And it is one that the tests know what to do with."""
    told = {place: block.partition("\n")[0][3:] for place, block in blocks()}
    assert {place: word for place, word in told.items() if word not in LANGUAGES} == {}


CHEAP = ("scene new", "scene render", "scene check", "scene generate", "scene list", "assets list")
"""Commands of which a page's lines are run as they stand."""


@pytest.mark.gl
@pytest.mark.parametrize("page", ["docs/scene_format.md", "docs/rooms.md"])
def test_cheap_lines_run_one_after_another(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In one folder, with the page's whole scene beside them as the file that it names."""
    monkeypatch.chdir(tmp_path)
    for place, text in blocks("yaml"):
        if place.startswith(page) and "A ball and a box" in text:
            (tmp_path / "my_scene.yaml").write_text(text)
    commands = [words for place, words in LINES.items() if place.startswith(page)]
    cheap = [words[1:] for words in commands if " ".join(words[1:3]) in CHEAP]
    assert len(cheap) >= 3
    assert [words for words in cheap if main(words) != 0] == []
    assert list(tmp_path.glob("*.png"))


def test_the_error_that_a_page_shows_is_the_one(tmp_path: Path) -> None:
    """Of `sailenv scene check`, for the page's scene with a name misspelt."""
    ((_, scene),) = (
        (place, text) for place, text in blocks("yaml") if "title: A ball and a box" in text
    )
    ((_, shown),) = ((place, text) for place, text in blocks("text") if "scene_format" in place)
    path = tmp_path / "my_scene.yaml"
    path.write_text(scene.replace("asset: plane", "asset: plain"))
    with pytest.raises(SceneError) as caught:
        load_scene(path, knowledge=SceneLibrary().knowledge)
    assert str(caught.value).replace(f"{tmp_path}/", "") == shown.strip()
