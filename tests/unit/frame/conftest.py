"""Things in the open before an agent, as a module describes them."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sailenv_ros.simulation import Simulation

OPEN = """
version: 1
settled: false
lights: [{name: sun, type: directional, direction: [1, 0.2, -1], intensity: 2}]
objects:
"""


@pytest.fixture(scope="module")
def simulation(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Simulation]:
    """The `THINGS` of the module before its agent `EYE`, which stays where it is."""
    path = tmp_path_factory.mktemp("open") / "things.yaml"
    path.write_text(OPEN + request.module.THINGS, encoding="utf-8")
    with Simulation(path, mode="lockstep", agent=request.module.EYE) as simulation:
        yield simulation
