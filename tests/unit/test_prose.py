"""The script that checks the language of pages finds what it should, and only that."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "prose.py"
SHORT = "A short sentence stands here. " * 30


def told(page: Path, text: str) -> list[str]:
    """Return what the script prints of a page."""
    page.write_text(text)
    command = [sys.executable, str(SCRIPT), str(page)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    found = done.stdout.strip().splitlines()
    assert done.returncode == (1 if found else 0), done.stderr
    assert all(line.startswith(f"{page}:") for line in found)
    return [line.removeprefix(f"{page}:") for line in found]


def words(count: int) -> str:
    return " ".join(["word"] * count) + "."


@pytest.fixture
def page(tmp_path: Path) -> Path:
    return tmp_path / "page.md"


def test_a_short_sentence_is_none(page: Path) -> None:
    """25 words are not too many, however many such sentences there are."""
    assert told(page, f"# Title\n\n{words(25)}\n\n- {words(25)}\n- {words(25)}\n") == []


def test_few_long_sentences_may_be(page: Path) -> None:
    """One of 31, but not two of 32, and none of over 40 words."""
    assert told(page, f"{SHORT}\n\n{words(26)}\n") == []
    assert told(page, f"{SHORT}\n\n{words(40)}\n") == []
    assert told(page, f"{SHORT}\n\n{words(41)}\n") == [f"3: 41 words: {words(41)}"]
    twice = told(page, f"{SHORT}\n\n{words(26)}\n{words(27)}\n")
    assert [line.partition(" words")[0] for line in twice] == ["3: 26", "4: 27"]


@pytest.mark.parametrize(
    "text",
    [
        f"```sh\n{words(60)}\n```\n",
        f"Text:\n\n    {words(60)}\n",
        f"| {words(60)} |\n|---|\n",
        f"# {words(60)}\n",
        f"See [a page](https://example.org/{words(60).replace(' ', '-')}).\n",
        f"A `{words(60)}` of code.\n",
        f"<!-- {words(60)} -->\n",
        "```sh\nmake anew  # now\n```\n",
        "A `thing anew` of code.\n",
    ],
)
def test_what_is_no_text_does_not_count(page: Path, text: str) -> None:
    """Programs, tables, headings, targets of links, code."""
    assert told(page, text) == []


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("It is made anew.", "'anew': write 'again'"),
        ("It is Worked out.", "'Worked out': write 'compute'"),
        ("| it was mended | x |", "'mended': write 'fix'"),
        ("It is fast now.", "'now' belongs to a diary"),
        ("It no longer waits.", "'no longer' belongs to a diary"),
    ],
)
def test_words_to_avoid_are_named(page: Path, text: str, fault: str) -> None:
    """With their line, and with what to write; in tables, too."""
    (line,) = told(page, f"Fine.\n\n{text}\n")
    assert line.startswith(f"3: {fault}")


def test_a_word_within_another_is_none(page: Path) -> None:
    """Such as in known, snow or amended."""
    assert told(page, "Known snow is amended.\n") == []


def test_a_sentence_goes_over_lines_and_ends_at_an_item(page: Path) -> None:
    """Its first line is told."""
    assert told(page, "Short.\n\n" + "word\n" * 41) == [f"3: 41 words: {words(41)[:-1]}"]
    assert told(page, "".join(f"- {words(20)[:-1]}\n" for _ in range(3))) == []


def test_docstrings_of_the_package_are_plain() -> None:
    """None begins with What, Which or Who or has a word to avoid: the script finds none."""
    done = subprocess.run(
        [sys.executable, str(SCRIPT)], capture_output=True, text=True, check=False
    )
    assert [line for line in done.stdout.splitlines() if ".py:" in line.split(" ")[0]] == []


def test_faults_of_docstrings_are_found(tmp_path: Path) -> None:
    """Openings and words, with their lines; code, names of parameters and two folders aside."""
    copy = tmp_path / "scripts" / "prose.py"
    copy.parent.mkdir()
    copy.write_text(SCRIPT.read_text())
    (tmp_path / "docs").mkdir()
    for name in ("README.md", "CONTRIBUTING.md"):
        (tmp_path / name).write_text("Fine.\n")
    (tmp_path / "sailenv_ros").mkdir()
    (tmp_path / "sailenv_ros" / "x.py").write_text(
        '"""What it is."""\n\nX = 1\n"""Which one."""\n\n\ndef f(anew):\n'
        '    """Whole, `anew`.\n\n    anew : bool\n        True begins anew.\n    """\n'
    )
    (tmp_path / "sailenv_content" / "standard").mkdir(parents=True)
    (tmp_path / "sailenv_content" / "standard" / "x.py").write_text('"""Made anew."""\n')
    done = subprocess.run([sys.executable, str(copy)], capture_output=True, text=True, check=False)
    assert done.stdout.splitlines() == [
        "sailenv_ros/x.py:1: What it is.",
        "sailenv_ros/x.py:4: Which one.",
        "sailenv_ros/x.py:11: 'anew': write 'again'",
    ]
    assert done.returncode == 1
