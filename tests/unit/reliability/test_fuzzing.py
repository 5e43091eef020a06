"""Whatever a stranger sends is accepted or refused in a sentence; the same inputs each time.

`benchmarks/fuzz.py` runs the same targets for as long as one likes.
"""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from tests.support.fuzzing import TARGETS, run_target

COUNTS = {
    "scene": 300,
    "scenario": 4000,
    "gateway": 4000,
    "viewer": 10_000,
    "glb": 600,
    "zip": 400,
    "mcap": 1500,
    "light": 1500,
    "asset": 1500,
}


@pytest.mark.parametrize("name", TARGETS)
def test_changed_samples_are_read_or_refused(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Some are accepted, so that what lies behind the first check is reached too."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    logging.getLogger("sailenv_ros.bake.light_files").disabled = True
    try:
        accepted = run_target(name, seed=1, count=COUNTS[name], folder=tmp_path)
    finally:
        logging.getLogger("sailenv_ros.bake.light_files").disabled = False
    assert 0 < accepted < COUNTS[name]
