"""A simulation with a gateway, for tests that talk to it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import sailenv_ros.simulation.simulation as module
from sailenv_ros.simulation import Simulation
from tests.support.blank_renderer import BlankRenderer


@pytest.fixture
def blank_simulation(monkeypatch: pytest.MonkeyPatch) -> Iterator[Simulation]:
    """A simulation in real time whose renderer draws nothing."""
    monkeypatch.setattr(module, "make_backend", lambda *_: BlankRenderer())
    with Simulation("optical") as simulation:
        yield simulation


@pytest.fixture(scope="module")
def lockstep() -> Iterator[Simulation]:
    """A simulation that draws and moves by step alone."""
    with Simulation("optical", mode="lockstep") as simulation:
        yield simulation
