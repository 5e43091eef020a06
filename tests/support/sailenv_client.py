"""The SAILenv client of PyPI, imported as it is, and connected to a gateway."""

from __future__ import annotations

import sys
import types
import typing
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sailenv_ros.gateway.session import AGENT_PREFIX
from sailenv_ros.simulation import Simulation

ANSWER_S = 60.0
"""Time that a test waits for an answer [s]."""


def _client_class() -> Any:
    if sys.version_info >= (3, 13):
        # The client imports a module that Python had until 3.12.
        module = types.ModuleType("typing.io")
        module.BinaryIO = typing.BinaryIO  # type: ignore[attr-defined]
        sys.modules.setdefault("typing.io", module)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of that module
        from sailenv.agent import Agent
    return Agent


OriginalAgent = _client_class()


@contextmanager
def original_client(port: int, **settings: Any) -> Iterator[Any]:
    """Return a client that has registered; it says good-bye at the end."""
    client = OriginalAgent(host="127.0.0.1", port=port, **settings)
    client.socket.settimeout(ANSWER_S)
    try:
        client.register()
        yield client
        client.delete()
    finally:
        client.socket.close()


def clients_of(simulation: Simulation) -> list[str]:
    """Return the names of the agents that clients of a gateway have."""
    names = [agent.name for agent in simulation.info.agents]
    return [name for name in names if name.startswith(AGENT_PREFIX)]
