"""The scene that a module describes as `STAGE`, in a file and in lockstep."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from sailenv_ros.simulation.synchronous import SynchronousSimulation
from tests.support.lockstep_core import lockstep_core


@pytest.fixture
def stage(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / "stage.yaml"
    path.write_text(request.module.STAGE, encoding="utf-8")
    return path


@pytest.fixture
def core(stage: Path) -> Iterator[SynchronousSimulation]:
    made = lockstep_core(stage)
    yield made
    made.close()
