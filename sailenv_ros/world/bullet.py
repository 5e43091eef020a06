"""A PyBullet client that cannot be confused with another, and whose failures are ours.

Every call carries the client's number; PyBullet's own errors become `PhysicsError`.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from sailenv_ros.errors import PhysicsError
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND

__all__ = ["LINK_OF_BASE", "STEPS_PER_SECOND", "BulletClient", "sim_time_ns"]

LINK_OF_BASE = -1
"""PyBullet's number for a body without joints."""

_import_lock = threading.Lock()


def sim_time_ns(step: int) -> int:
    """Return the simulated time after so many steps [ns]; exact to the nanosecond, never drifts."""
    return step * 1_000_000_000 // STEPS_PER_SECOND


def load_pybullet() -> Any:
    """Import pybullet without the build-time banner it prints."""
    with _import_lock:
        if "pybullet" in sys.modules:
            return sys.modules["pybullet"]
        with _silent_output():
            import pybullet
        return pybullet


class BulletClient:
    """One private physics world without a window.

    Attribute access gives PyBullet's function of that name, bound to this client:
    ``client.getNumBodies()``.

    Attributes
    ----------
    moments : int
        Another number after whatever may have moved all bodies: a step, or a state restored.
    """

    def __init__(self) -> None:
        self._pybullet = load_pybullet()
        self._id: int = self._pybullet.connect(self._pybullet.DIRECT)
        if self._id < 0:
            raise PhysicsError(
                "PyBullet gave no physics server (too many are open in this process)"
            )
        self._gravity = (0.0, 0.0, 0.0)
        self.moments = 0
        self._step, self._restore = self._bind("stepSimulation"), self._bind("restoreState")

    @property
    def gravity(self) -> tuple[float, float, float]:
        """Acceleration that pulls every body, world frame [m/s²]; PyBullet cannot tell it."""
        return self._gravity

    @gravity.setter
    def gravity(self, gravity: tuple[float, float, float]) -> None:
        self.setGravity(*gravity)
        self._gravity = gravity

    @property
    def constants(self) -> Any:
        """The pybullet module, for its constants."""
        return self._pybullet

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        bound = self._bind(name)
        self.__dict__[name] = bound  # the next call of it finds it there
        return bound

    def stepSimulation(self) -> None:  # noqa: N802  # PyBullet's name
        """Advance by a step."""
        self.moments += 1
        self._step()

    def restoreState(self, state: int) -> None:  # noqa: N802  # PyBullet's name
        """Put all back to where it was when a state was saved."""
        self.moments += 1
        self._restore(state)

    def close(self) -> None:
        """Free the physics world; a second call does nothing."""
        if self._id >= 0:
            self._pybullet.disconnect(physicsClientId=self._id)
            self._id = -1

    def _bind(self, name: str) -> Callable[..., Any]:
        function = getattr(self._pybullet, name)
        error = self._pybullet.error

        def call(*args: Any, **kwargs: Any) -> Any:
            if self._id < 0:
                raise PhysicsError(f"PyBullet's {name} was called on a closed world")
            try:
                return function(*args, physicsClientId=self._id, **kwargs)
            except error as problem:
                raise PhysicsError(f"PyBullet's {name} failed: {problem}") from None

        return call


@contextmanager
def _silent_output() -> Iterator[None]:
    """Send file descriptors 1 and 2 to nowhere: the banner is written by C code to either."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = {descriptor: os.dup(descriptor) for descriptor in (1, 2)}
    sink = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in saved:
            os.dup2(sink, descriptor)
        yield
    finally:
        for descriptor, copy in saved.items():
            os.dup2(copy, descriptor)
            os.close(copy)
        os.close(sink)
