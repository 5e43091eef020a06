"""Checks of pull requests and of commits: their files are valid, and name scripts that exist."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
HOOKS: dict[str, Any] = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())
ROOMS = ROOT / "scripts" / "coverage_rooms.py"


def steps() -> list[dict[str, Any]]:
    """Return all steps of all workflows."""
    jobs = [yaml.safe_load(path.read_text())["jobs"].values() for path in WORKFLOWS]
    return [step for of_file in jobs for job in of_file for step in job["steps"]]


def test_a_pull_request_is_set_up_checked_and_tested() -> None:
    """By the scripts of the repository, in this order; each can be executed."""
    scripts = [step["run"].split()[0] for step in steps() if "run" in step]
    assert scripts == ["scripts/setup", "scripts/check", "scripts/sanitize", "scripts/test"]
    assert all(os.access(ROOT / script, os.X_OK) for script in scripts)


def test_actions_are_pinned() -> None:
    """To a commit: a tag can be moved."""
    used = [step["uses"] for step in steps() if "uses" in step]
    assert used
    assert [action for action in used if not re.fullmatch(r"[\w/-]+@[0-9a-f]{40}", action)] == []


def test_hooks_need_no_network() -> None:
    """All are local, and run programs of the environment or scripts that exist."""
    assert [repository["repo"] for repository in HOOKS["repos"]] == ["local"]
    for hook in HOOKS["repos"][0]["hooks"]:
        assert hook["language"] == "system"
        words = hook["entry"].split()
        assert words[0].startswith(".venv/bin/")
        for word in words[1:]:
            assert not word.startswith("scripts/") or (ROOT / word).is_file()
        for pattern in ("files", "exclude"):
            re.compile(hook.get(pattern, ""))


@pytest.mark.parametrize(
    ("pattern", "path"),
    [("clang-format", "sailenv_ros/native/src/kernels/motion.cpp"), ("prose", "docs/light.md")],
)
def test_hooks_find_their_files(pattern: str, path: str) -> None:
    """The pattern of a hook matches a file that exists."""
    hook = next(one for one in HOOKS["repos"][0]["hooks"] if one["id"] == pattern)
    assert (ROOT / path).is_file()
    assert re.search(hook["files"], path)


def test_coverage_is_told_by_room(tmp_path: Path) -> None:
    """The least covered first, wherever the package was installed; empty files do not count."""
    files = {
        "build/installed/lib/python3/site-packages/sailenv_ros/scene/a.py": (1, 4),
        "sailenv_ros/sailenv_ros/scene/b.py": (2, 2),
        "/clone/sailenv_ros/sailenv_content/x.py": (3, 12),
        "sailenv_ros/types/__init__.py": (0, 0),
        "tests/unit/test_x.py": (9, 9),
    }
    report = {
        "files": {
            path: {"summary": {"covered_lines": ran, "num_statements": count}}
            for path, (ran, count) in files.items()
        }
    }
    (tmp_path / "coverage.json").write_text(json.dumps(report))
    command = [sys.executable, str(ROOMS), str(tmp_path / "coverage.json")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = [line.split() for line in done.stdout.splitlines()]
    assert [(line[0], line[1], line[3], line[5]) for line in lines] == [
        ("sailenv_content", "3", "12", "25.0"),
        ("scene", "3", "6", "50.0"),
        ("all", "6", "18", "33.3"),
    ]
