"""What the groups of an Agent's requests have in common: a way to ask, and the scene as announced.

`SimulatorClient` has the connection behind it. Knows no topic and no frame.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene_info import SceneInfo

__all__ = ["Asking", "text_of"]


class Asking:
    """Base of the groups of requests."""

    @property
    def _info(self) -> SceneInfo:
        """The scene as it was announced last."""
        raise NotImplementedError

    def _call(
        self, srv_type: Any, service: str, request: Any, timeout_s: float | None = None
    ) -> Any:
        """Ask a service; give its answer, which says success."""
        raise NotImplementedError

    def _await_info(self, condition: Callable[[SceneInfo], bool], what: str) -> None:
        """Wait until the announced scene is as it should be."""
        raise NotImplementedError


def text_of(what: str, value: object) -> str:
    """Check that a value is a text, before a message would complain in words of its own."""
    if not isinstance(value, str):
        raise InvalidRequest(what, value, "a text")
    return value
