"""How the types of the page are checked: TypeScript is fetched by npm, or asked for in words."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FAKE_NPM = """#!/usr/bin/env bash
[[ $1 == ci && $2 == --prefix && -f $3/package-lock.json ]] || exit 2
mkdir -p "$3/node_modules/.bin"
printf '#!/bin/sh\\necho "tsc $*"\\n' > "$3/node_modules/.bin/tsc"
chmod +x "$3/node_modules/.bin/tsc"
echo fetched
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """The scripts alone, with messages that are always those of the program."""
    scripts = tmp_path / "scripts"
    scripts.mkdir()
    for name in ("common.sh", "page-types"):
        shutil.copy(ROOT / "scripts" / name, scripts)
    shutil.copytree(ROOT / "scripts" / "typescript", scripts / "typescript")
    messages = scripts / "page_messages.py"
    messages.write_text("#!/bin/sh\n")
    messages.chmod(0o755)
    npm = tmp_path / "bin" / "npm"
    npm.parent.mkdir()
    npm.write_text(FAKE_NPM)
    npm.chmod(0o755)
    return tmp_path


def run(tree: Path, *arguments: str, npm: bool = True) -> subprocess.CompletedProcess[str]:
    """Run the script there; without `npm` nothing but the shell's own tools is found."""
    tools = tree / "tools"
    tools.mkdir(exist_ok=True)
    for name in ("bash", "cmp", "cp", "dirname", "env", "mkdir", "rm", "sh", "chmod"):
        if not (tools / name).exists():
            (tools / name).symlink_to(str(shutil.which(name)))
    path = os.pathsep.join([str(tree / "bin"), str(tools)] if npm else [str(tools)])
    return subprocess.run(
        [str(tree / "scripts" / "page-types"), *arguments],
        capture_output=True,
        text=True,
        env={"PATH": path},
        check=False,
    )


def test_what_is_missing_is_told_in_a_sentence(tree: Path) -> None:
    """Without TypeScript the check fails and says how to get it; so does fetching without npm."""
    told = run(tree)
    assert told.returncode == 1
    assert "there is no TypeScript" in told.stderr
    assert "scripts/page-types --fetch" in told.stderr
    told = run(tree, "--fetch", npm=False)
    assert told.returncode == 1
    assert "there is no npm" in told.stderr


def test_it_is_fetched_once_for_each_lock(tree: Path) -> None:
    """And then the page is checked; another pinned version is fetched anew."""
    assert "fetched" in run(tree, "--fetch").stdout
    assert run(tree, "--fetch").stdout == ""
    checked = run(tree)
    assert checked.returncode == 0
    assert checked.stdout == "tsc --project sailenv_ros/viewer\n"
    lock = tree / "scripts" / "typescript" / "package-lock.json"
    lock.write_text(lock.read_text() + "\n")
    assert run(tree).returncode == 1
    assert "fetched" in run(tree, "--fetch").stdout


def test_the_version_is_pinned_with_its_hash() -> None:
    """By the lock that npm holds what it fetches against."""
    lock = (ROOT / "scripts" / "typescript" / "package-lock.json").read_text()
    assert '"integrity": "sha512-' in lock
    assert '"typescript": "5.' in (ROOT / "scripts" / "typescript" / "package.json").read_text()
