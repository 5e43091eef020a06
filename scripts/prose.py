#!/usr/bin/env python3
"""Check the language of pages and docstrings: long sentences, words to avoid, diary, openings.

    scripts/prose.py                   # README, CONTRIBUTING, docs/, docstrings
    scripts/prose.py docs/light.md     # some pages alone

Prints ``file:line: sentence`` of each fault. Tables, programs, headings, names and types of
parameters and links' targets do not count. Of a page's sentences 5 % may have over 25 words, none
over 40. README and pages have at most 35,000 words together, and none more than 3,000, as `wc -w`
counts them.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = (
    "sailenv_ros", "sailenv_msgs_py", "sailenv_content", "sailenv_bench", "benchmarks", "scripts",
    "tests/support",
)  # fmt: skip
LEFT_OUT = ("sailenv_content/procedural", "sailenv_content/standard")
"""Folders whose docstrings keep their words, where a change builds all furniture again."""

MOST_WORDS, MOST_OF_PAGE = 35_000, 3_000

LONG, LONGEST = 25, 40
SHARE = 0.05
"""Of a page's sentences that may be long."""

FEW = 12
"""Pages with fewer sentences may have one long one."""

DIARY = r"now|today|today's|no longer|so far|before this|since then|used to|meanwhile"
WORDS = {
    r"anew": "again",
    r"at worst": "at most",
    r"at the latest": "within ... s",
    r"broken off|breaks? off": "interrupted",
    r"brought to the disk": "synced",
    r"brought up to date|brings? up to date": "updated",
    r"by the clock": "wall time",
    r"by way of": "through",
    r"fall(?:s|en)? silent": "stop responding",
    r"for ever": "forever",
    r"go(?:es)? on": "continues",
    r"hands? on": "passes on",
    r"hangs? on": "depends on",
    r"held against|holds? against": "compared with",
    r"hitherto|henceforth|therein|thereof|whereof|whilst|thereby": "a plain word",
    r"in the end": "finally",
    r"in one go": "together",
    r"laid flat|laying flat|lays flat": "unwrapped",
    r"mend(?:s|ed|ing)?": "fix",
    r"on the mean": "on average",
    r"passed over": "skipped",
    r"spoken of|speaks? of": "refers to",
    r"strangers?": "others, untrusted",
    r"that which|those which": "what, the ones that",
    r"thr(?:ow|own|ew) away": "deleted",
    r"to be had": "available",
    r"told apart|tells? apart": "distinguish",
    r"whoever|whosoever": "the user, the process that",
    r"works? out|worked out": "compute",
    r"look(?:s|ed)? like that": "is similar",
    r"as good as": "nearly",
    r"of late|of old": "recently",
}
"""Words that are not the field's terms, or translated idioms, and what to write instead."""

AVOID = re.compile(rf"\b(?:{'|'.join(WORDS)})\b", re.IGNORECASE)
DIARY_WORD = re.compile(rf"\b(?:{DIARY})\b", re.IGNORECASE)
DECLARATION = re.compile(r"\w+(?:, \w+)* : ")
"""Begins the line of a parameter in NumPy's style: its names and type."""

OPENING = re.compile(r"\W*(What|Which|Who|Whose|Whom)\b")
ABBREVIATION = re.compile(r"\b(?:e\.g|i\.e|etc|vs|approx|Mr|Dr|no|Fig)\.$", re.IGNORECASE)

Sentence = tuple[int, str]


def plain(text: str) -> str:
    """Return a line of Markdown without code, targets of links and emphasis."""
    text = re.sub(r"<!--.*?-->|<[^>]+>", " ", text)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", " ", text)
    text = re.sub(r"``[^`]+``|`[^`]+`", "code", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"^(\s*)[*] ", r"\1- ", text).replace("*", "")


def text_lines(page: str) -> Iterator[Sentence]:
    """Yield number and text of each line that belongs to no program; lines of programs empty."""
    fenced, before = False, ""
    for number, line in enumerate(page.splitlines(), 1):
        fence = line.lstrip().startswith(("```", "~~~"))
        fenced ^= fence
        code = line.startswith("    ") and not before.strip()
        before = "" if code else line
        yield number, "" if fenced or fence or code else plain(line).rstrip()


def paragraphs(page: str) -> Iterator[list[Sentence]]:
    """Yield paragraphs and list items, as lines with their numbers."""
    lines: list[Sentence] = []
    for number, line in [*text_lines(page), (0, "")]:
        item = re.match(r"\s*(?:[-+>]|\d+\.)\s", line)
        no_text = not line.strip() or line.lstrip().startswith(("|", "#"))
        if (no_text or item) and lines:
            yield lines
            lines = []
        if not no_text:
            lines.append((number, line[item.end() :] if item else line))


def sentences(page: str) -> Iterator[Sentence]:
    """Yield each sentence of a page with the line on which it begins."""
    for lines in paragraphs(page):
        begun, words = lines[0][0], list[str]()
        for number, line in lines:
            for word in line.split():
                if not words:
                    begun = number
                words.append(word)
                if re.search(r"[.!?][\"')”]*$", word) and not ABBREVIATION.search(word):
                    yield begun, " ".join(words)
                    words = []
        if words:
            yield begun, " ".join(words)


def length(sentence: str) -> int:
    """Return the number of words, of which each has a letter or a digit."""
    return sum(any(sign.isalnum() for sign in word) for word in sentence.split())


def faults_of(page: str) -> Iterator[Sentence]:
    """Yield line and fault of a page's sentences."""
    found = list(sentences(page))
    long = [(line, text) for line, text in found if length(text) > LONG]
    if len(long) > max(SHARE * len(found), 1 if len(found) < FEW else 0):
        for line, text in long:
            yield line, f"{length(text)} words: {text}"
    else:
        for line, text in long:
            if length(text) > LONGEST:
                yield line, f"{length(text)} words: {text}"
    for number, text in text_lines(page):
        for match in AVOID.finditer(text):
            yield number, f"'{match[0]}': write '{instead_of(match[0])}': {text.strip()[:120]}"
        for match in DIARY_WORD.finditer(text):
            yield number, f"'{match[0]}' belongs to a diary: {text.strip()[:120]}"


def instead_of(word: str) -> str:
    """Return the replacement of a word to avoid."""
    return next(new for old, new in WORDS.items() if re.fullmatch(old, word, re.IGNORECASE))


def docstrings(source: str) -> Iterator[Sentence]:
    """Yield line and text of each docstring of a module, those of attributes included."""
    for node in ast.walk(ast.parse(source)):
        body = getattr(node, "body", None)
        for statement in body if isinstance(body, list) else ():
            value = statement.value if isinstance(statement, ast.Expr) else None
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield value.lineno, value.value


def faults_of_docstring(text: str, *, words: bool = True) -> Iterator[Sentence]:
    """Yield line, from 0, and fault: how it begins, and the words to avoid if those count."""
    if OPENING.match(text):
        yield 0, text.strip().splitlines()[0]
    for number, line in text_lines(inspect.cleandoc(text)) if words else ():
        if not DECLARATION.match(line):
            for match in AVOID.finditer(line):
                yield number - 1, f"'{match[0]}': write '{instead_of(match[0])}'"


def sources() -> Iterator[tuple[str, str]]:
    """Yield name and text of each Python file whose docstrings are checked."""
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*.py")):
            yield str(path.relative_to(ROOT)), path.read_text(encoding="utf-8")


def main() -> int:
    """Print all faults; 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="*", type=Path)
    args = parser.parse_args()
    written = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
    found = []
    for path in args.pages or written:
        page = path.read_text(encoding="utf-8")
        name = path if args.pages else path.relative_to(ROOT)
        found += [f"{name}:{line}: {fault}" for line, fault in sorted(faults_of(page))]
        if len(page.split()) > MOST_OF_PAGE:
            found.append(f"{name}:1: it has {len(page.split())} words; at most {MOST_OF_PAGE}")
    counted = [path for path in written if path.name != "CONTRIBUTING.md"]
    words = sum(len(path.read_text(encoding="utf-8").split()) for path in counted)
    if words > MOST_WORDS:
        found.append(f"README.md and docs/: they have {words} words; at most {MOST_WORDS}")
    for name, source in () if args.pages else sources():
        for line, text in docstrings(source):
            faults = faults_of_docstring(text, words=not name.startswith(LEFT_OUT))
            found += [f"{name}:{line + after}: {fault}" for after, fault in faults]
    print("\n".join(found))
    print(f"{len(found)} faults of language", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
