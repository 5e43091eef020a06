"""A lockstep simulation behind the gateway, told on standard input when to step.

A scene's name in; the port, and a line after each step, out.
"""

from __future__ import annotations

import sys

from sailenv_ros.gateway import GatewayServer
from sailenv_ros.simulation.simulation import Simulation
from sailenv_ros.system.memory import keep_freed_memory

__all__ = ["main"]


def main() -> None:
    """Serve until standard input ends."""
    keep_freed_memory()
    with (
        Simulation(sys.argv[1], mode="lockstep") as simulation,
        GatewayServer(simulation, port=0) as gateway,
    ):
        _say(f"{gateway.port} {simulation.info.renderer}")
        for line in sys.stdin:
            simulation.step(int(line))
            _say("stepped")


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
