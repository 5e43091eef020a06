"""The work on models that is done beside the simulation's loop: uploads and thumbnails."""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.simulation.models.thumbnails import Thumbnails
from sailenv_ros.simulation.models.upload_queue import UploadQueue

__all__ = ["ModelWorkers"]


@dataclass(frozen=True, slots=True)
class ModelWorkers:
    """Workers of one simulation; what the operations on models run on."""

    uploads: UploadQueue
    thumbnails: Thumbnails

    def close(self) -> None:
        """Refuse what waits and take no more; a second call does nothing."""
        self.uploads.close()
        self.thumbnails.close()
