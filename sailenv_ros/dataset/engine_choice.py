"""The choice between the engines: this process, processes of this machine, or a Ray cluster."""

from __future__ import annotations

from sailenv_ros.dataset.engines import Engine, HereEngine, ProcessEngine

__all__ = ["engine_of"]


def engine_of(workers: int, ray_address: str | None) -> Engine:
    """Return the engine for so many workers here, or for a Ray cluster."""
    if ray_address is not None:
        from sailenv_ros.dataset.ray_engine import RayEngine

        return RayEngine(ray_address)
    return ProcessEngine(workers) if workers > 1 else HereEngine()
