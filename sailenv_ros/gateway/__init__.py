"""The socket protocol of the SAILenv client, so that its scripts run on this simulator.

Bytes in, requests to `simulation/` and bytes out. Knows no ROS.
"""

from sailenv_ros.gateway.gateway_server import DEFAULT_HOST, DEFAULT_PORT, GatewayServer

__all__ = ["DEFAULT_HOST", "DEFAULT_PORT", "GatewayServer"]
