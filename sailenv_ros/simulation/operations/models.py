"""Operations on models of the catalogue; they run beside the simulation, which continues."""

from __future__ import annotations

import io
from concurrent.futures import Future
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, background_operation

if TYPE_CHECKING:
    from sailenv_ros.simulation.models.model_workers import ModelWorkers

__all__ = ["ModelOperations"]

UPLOAD_S = 120.0
"""Time limit of an upload unless another is given [s]."""


class ModelOperations(Caller):
    """Models of one's own, and small pictures of the catalogue."""

    @background_operation(
        deadline_s=UPLOAD_S,
        filename=check.text,
        name=check.text,
        category=check.text,
        height_m=check.number,
    )
    @staticmethod
    def upload_model(
        workers: ModelWorkers,
        data: bytes,
        filename: str,
        *,
        name: str = "",
        category: str = "",
        height_m: float = 0.0,
    ) -> Future[str]:
        """Add a model to the catalogue; return the name that `spawn_object` takes.

        Parameters
        ----------
        data : bytes
            A zip archive of one obj with its mtl and textures, or a glb; at most 64 MB.
        filename : str
            Of which the ending counts: ``.zip`` or ``.glb``.
        name : str
            Name in the catalogue; empty makes one of the file's, with a number where it is in use.
        category : str
            Name of its category; empty leaves it unlabelled.
        height_m : float
            Height that it is scaled to [m]; 0 takes its unit for the metre.

        Raises
        ------
        NameTaken, UnknownName, InvalidRequest, AssetError
            If it cannot be used; the catalogue is as it was then.
        """
        return workers.uploads.begin(
            data,
            name=name,
            filename=filename,
            category=category or None,
            height_m=height_m or None,
        )

    @background_operation(deadline_s=60.0, asset=check.text)
    @staticmethod
    def get_thumbnail_png(workers: ModelWorkers, asset: str) -> Future[bytes]:
        """Return a picture of an object of the catalogue as a PNG file of 160 by 120 pixels.

        Drawn at the first request by a process beside the simulator and kept in the user's cache.

        Parameters
        ----------
        asset : str
            Catalogue or display name.

        Raises
        ------
        UnknownName
            If there is no such asset.
        RenderError, DeadlineExceeded
            If it cannot be drawn.
        """
        return workers.thumbnails.begin(asset)

    def get_thumbnail(self, asset: str) -> NDArray[np.uint8]:
        """Return a picture of an object of the catalogue, (120, 160, 3) uint8 BGR."""
        from PIL import Image

        with Image.open(io.BytesIO(self.get_thumbnail_png(asset))) as picture:
            return np.asarray(picture.convert("RGB"))[..., ::-1].copy()

    def send_obj_zip(
        self,
        file: str | Path | BinaryIO,
        filename: str | None = None,
        *,
        name: str = "",
        category: str = "",
        height_m: float = 0.0,
        timeout_s: float = UPLOAD_S,
    ) -> str:
        """Upload a model from a file; see `upload_model`.

        Parameters
        ----------
        file : str, Path or binary file
        filename : str or None
            Its name, of which the ending counts; needed where an open file is given.
        timeout_s : float
            Deadline [s]; finding its collision pieces takes time.
        """
        data, filename = _content(file, filename)
        upload = self.upload_model.within(timeout_s)
        return upload(data, filename, name=name, category=category, height_m=height_m)


def _content(file: str | Path | BinaryIO, filename: str | None) -> tuple[bytes, str]:
    """Read an uploaded file; return its bytes and its name."""
    if isinstance(file, str | Path):
        try:
            return Path(file).read_bytes(), filename or Path(file).name
        except OSError as problem:
            raise InvalidRequest("file", str(file), f"one that can be read ({problem})") from None
    if filename is None or not hasattr(file, "read"):
        raise InvalidRequest("file", file, "a path, or an open binary file with its filename")
    data: object = file.read()
    if not isinstance(data, bytes):
        raise InvalidRequest("file", file, "open for bytes, not for text")
    return data, check.text("filename", filename)
