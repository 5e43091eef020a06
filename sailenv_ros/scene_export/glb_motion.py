"""Motion of a scene as one animation of glTF: poses of nodes, shapes as morph targets.

Each sample of what deforms is a target of its own. Its weight is 1 at its time and 0 at those of
its neighbours, so that between two samples vertices go straight.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.glb_buffers import GlbBuffers
from sailenv_ros.scene_export.motion import ExportedMotion
from sailenv_ros.types.deformation import MovedMesh
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import ModelPart

__all__ = ["GlbMotion"]


class GlbMotion:
    """The animation of one file.

    Parameters
    ----------
    motion : ExportedMotion
    buffers : GlbBuffers
    """

    def __init__(self, motion: ExportedMotion, buffers: GlbBuffers) -> None:
        self._motion, self._buffers = motion, buffers
        self._times = buffers.samples(motion.times_s, bounds=True)
        self._channels: list[dict[str, Any]] = []
        self._samplers: list[dict[str, Any]] = []

    def add_poses(
        self, node: int, poses: Iterable[Pose], placed: Callable[[Pose], dict[str, Any]]
    ) -> None:
        """Let a node follow poses, which a function turns into what nodes have."""
        own = [placed(pose) for pose in poses]
        places = np.array([one["translation"] for one in own])
        turns = np.array([one["rotation"] for one in own])
        # Both signs are one turn; neighbours have the same, else a reader turns the long way round.
        flips = (turns[1:] * turns[:-1]).sum(axis=1) < 0.0
        turns[1:] *= np.where(np.cumsum(flips) % 2, -1.0, 1.0)[:, None]
        self._add(node, "translation", places)
        self._add(node, "rotation", turns)

    def targets(self, part: ModelPart, samples: Sequence[MovedMesh]) -> list[dict[str, int]]:
        """Return the morph targets of a part, one for each sample."""
        mesh, buffers = part.mesh, self._buffers
        return [
            {
                "POSITION": buffers.moved(mesh.positions, moved.positions, bounds=True),
                "NORMAL": buffers.moved(mesh.normals, moved.normals, bounds=False),
            }
            for moved in samples
        ]

    def add_weights(self, node: int) -> None:
        """Let a node's mesh go from target to target."""
        self._add(node, "weights", np.eye(len(self._motion.times_s)).reshape(-1))

    def entry(self) -> dict[str, Any]:
        """Return the animation."""
        return {"name": "motion", "channels": self._channels, "samplers": self._samplers}

    @property
    def moves(self) -> bool:
        """Whether anything does."""
        return bool(self._channels)

    def _add(self, node: int, path: str, values: NDArray[np.float64]) -> None:
        sampler = {"input": self._times, "output": self._buffers.samples(values)}
        self._channels.append(
            {"sampler": len(self._samplers), "target": {"node": node, "path": path}}
        )
        self._samplers.append(sampler)
