"""Whatever a stranger sends is accepted or refused in a sentence; the same inputs each time.

`benchmarks/fuzz.py` runs the same targets for as long as one likes.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.fuzzing import TARGETS, kept, replay, run_target

COUNTS = {
    "scene": 300,
    "scenario": 4000,
    "gateway": 4000,
    "viewer": 10_000,
    "glb": 600,
    "gltf": 600,
    "zip": 400,
    "mcap": 1500,
    "light": 1500,
    "asset": 1500,
}


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    log = logging.getLogger("sailenv_ros.light.bake.light_files")
    log.disabled = True
    yield
    log.disabled = False


@pytest.mark.parametrize("name", TARGETS)
def test_kept_inputs_are_read_or_refused(name: str, tmp_path: Path) -> None:
    """Those that reached something new once, found by coverage, and the samples."""
    assert kept(name)
    assert replay(name, tmp_path) >= len(TARGETS[name].samples())


@pytest.mark.parametrize("name", TARGETS)
def test_changed_samples_are_read_or_refused(name: str, tmp_path: Path) -> None:
    """Some are accepted, so that what lies behind the first check is reached too."""
    accepted = run_target(name, seed=1, count=COUNTS[name], folder=tmp_path)
    assert 0 < accepted < COUNTS[name]
