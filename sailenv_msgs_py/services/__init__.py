"""Operations as ROS services: each operation's service, and both directions of its messages."""

from sailenv_msgs_py.services.service import Service
from sailenv_msgs_py.services.table import AGENT_SERVICES, SERVICES, SIMULATOR_SERVICES

__all__ = ["AGENT_SERVICES", "SERVICES", "SIMULATOR_SERVICES", "Service"]
