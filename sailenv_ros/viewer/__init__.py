"""The web viewer: a page in the browser that shows what agents see and lets people walk and build.

Frames of `simulation/` in, pictures over one WebSocket out; wishes of people in, requests out.
Knows no ROS.
"""

from sailenv_ros.viewer.web_server import DEFAULT_HOST, DEFAULT_PORT, ViewerServer

__all__ = ["DEFAULT_HOST", "DEFAULT_PORT", "ViewerServer"]
