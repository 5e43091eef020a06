"""The blocks of code in README.md and docs/, by their language.

``python`` is a whole program, which a test runs; ``py`` a fragment, which a test parses and binds;
``sh`` lines for a shell; ``yaml`` a file or a part of one; ``text`` what a program prints.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

from tests.packaging.project import ROOT

__all__ = ["LANGUAGES", "PAGES", "blocks", "sailenv_words", "shell_lines"]

PAGES = [ROOT / "README.md", *sorted(ROOT.glob("docs/**/*.md"))]

LANGUAGES = {"python", "py", "sh", "yaml", "text"}

_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def blocks(language: str | None = None, pages: list[Path] = PAGES) -> Iterator[tuple[str, str]]:
    """Yield each block of a language with its place; of all languages without one."""
    for page in pages:
        text = page.read_text()
        for found in _BLOCK.finditer(text):
            if language in (None, found[1]):
                line = text.count("\n", 0, found.start()) + 1
                yield f"{page.relative_to(ROOT)}:{line}", found[0 if language is None else 2]


def shell_lines() -> dict[str, list[str]]:
    """Return the words of each command of each block for a shell, by its place and text.

    Assignments before a command are left out; ``a && b`` is two commands.
    """
    found = {}
    for place, block in blocks("sh"):
        for line in block.replace("\\\n", " ").splitlines():
            words = shlex.split(line, comments=True)
            while words:
                end = words.index("&&") if "&&" in words else len(words)
                command, words = words[:end], words[end + 1 :]
                while command and re.match(r"[A-Z_]+=", command[0]):
                    command = command[1:]
                if command:
                    found[f"{place}: {' '.join(command)[:60]}"] = command
    return found


def sailenv_words(words: list[str]) -> list[str]:
    """Return the words after ``sailenv``; what stands for another word becomes such a one."""
    stands_for = {"N": "1", "F…": "png"}
    return [stands_for.get(word, word) for word in words if word != "…"]
