"""No two modules and no two classes of one name: a name in a log or a question means one thing."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("sailenv_ros", "sailenv_msgs_py")
FOLDERS = (*PACKAGES, "benchmarks", "examples", "scripts", "tests")
FREE = ("__init__", "conftest")
"""Python and pytest want these names."""


def modules(folders: tuple[str, ...]) -> list[Path]:
    """Return every module of a checkout; at least the tests' own."""
    found = [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]
    return [path for path in found if path.stem not in FREE]


def repeated(places: dict[str, list[str]]) -> dict[str, list[str]]:
    """Return the names that have several places."""
    return {name: found for name, found in places.items() if len(found) > 1}


def test_no_two_modules_have_one_name() -> None:
    places = defaultdict(list)
    for path in modules(FOLDERS):
        places[path.stem].append(str(path.relative_to(ROOT)))
    assert places["test_names"] == ["tests/unit/test_names.py"]
    assert repeated(places) == {}


def test_no_two_classes_have_one_name() -> None:
    """Those at the top of the packages' modules, private ones too."""
    places = defaultdict(list)
    for path in modules(PACKAGES):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef):
                places[node.name].append(str(path.relative_to(ROOT)))
    assert repeated(places) == {}


def test_repeated_names_are_found() -> None:
    assert repeated({"a": ["x.py"], "b": ["x.py", "y.py"]}) == {"b": ["x.py", "y.py"]}
