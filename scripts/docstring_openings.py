#!/usr/bin/env python3
"""Counts docstrings that begin with a question word, and fails if there are too many.

A docstring names the thing: "Result of one step", not "What one step returns". Some sentences are
clearer the other way; so a few may stay.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

FOLDERS = (
    "sailenv_ros",
    "sailenv_msgs_py",
    "sailenv_content",
    "sailenv_bench",
    "benchmarks",
    "scripts",
    "tests/support",
)
MOST = 20
OPENING = re.compile(r"\W*(What|Which|Who|Whose|Whom)\b")


def docstrings(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and text of each docstring of a module, those of attributes included."""
    for node in ast.walk(ast.parse(source)):
        body = getattr(node, "body", None)
        for statement in body if isinstance(body, list) else ():
            value = statement.value if isinstance(statement, ast.Expr) else None
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield value.lineno, value.value


def main() -> int:
    """Print the docstrings that begin so if they are too many; return the exit status."""
    root = Path(__file__).resolve().parents[1]
    found = [
        f"{path.relative_to(root)}:{line}: {text.strip().splitlines()[0]}"
        for folder in FOLDERS
        for path in sorted((root / folder).rglob("*.py"))
        for line, text in docstrings(path.read_text(encoding="utf-8"))
        if OPENING.match(text)
    ]
    if len(found) <= MOST:
        return 0
    print("\n".join(found))
    print(f"{len(found)} docstrings begin with What, Which or Who; {MOST} may.", file=sys.stderr)
    return 1


if __name__ == "__main__":
    raise SystemExit(main())
