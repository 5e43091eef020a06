"""The web viewer: a page in the browser that shows what agents see and lets people walk and build.

Frames of `simulation/` in, pictures over one WebSocket out; wishes of people in, requests out.
Knows no ROS. The server and its web library are imported when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sailenv_ros.viewer.address import DEFAULT_HOST, DEFAULT_PORT

if TYPE_CHECKING:
    from sailenv_ros.viewer.web_server import ViewerServer

__all__ = ["DEFAULT_HOST", "DEFAULT_PORT", "ViewerServer"]


def __getattr__(name: str) -> Any:
    if name != "ViewerServer":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from sailenv_ros.viewer.web_server import ViewerServer

    return ViewerServer
