"""Operations on materials: what objects, walls, floors and ceilings are made of."""

from __future__ import annotations

import io
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Unpack

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.requested_changes import MaterialChanges
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasEditor, HasLibrary

__all__ = ["MaterialOperations"]


class MaterialOperations(Caller):
    """Materials, by the keys that they have in a scene file."""

    @operation(deadline_s=60.0, obj=check.object_reference, part=check.text)
    @staticmethod
    def set_material(
        core: HasEditor, obj: int | str, part: str = "", /, **changes: Unpack[MaterialChanges]
    ) -> None:
        """Change what an object, a wall, the floor or the ceiling is made of; its shape stays.

        Parameters
        ----------
        obj : int or str
            Of a room's skirting, windows, doors and curtains the colour can be changed.
        part : str
            Name of one of the object's materials, which `info.instances` tell; empty for all of
            it, which ends what was said of single ones.
        **changes
            ``material``, ``picture``, ``colour``, ``tint``, ``roughness``, ``metallic``,
            ``emission``, ``tile``, ``turn``, ``seed``, ``mapping``, as in a scene file. What is not
            given stays as it is; None takes the asset's own. No changes at all: all is the
            asset's own again.

        Raises
        ------
        UnknownName, InvalidEntry, InvalidRequest, AssetError
            If it cannot be such a material; it is as it was then.

        >>> agent.set_material("couch", "Sit", material="carpet")  # doctest: +SKIP
        >>> agent.set_material("floor", material="oak_parquet", turn=45)  # doctest: +SKIP
        """
        core.editor.set_material(core.world.find(obj), part, changes)

    @operation(deadline_s=60.0)
    @staticmethod
    def upload_picture(core: HasLibrary, data: bytes) -> str:
        """Take a picture for materials; return the name that `set_material` takes.

        Parameters
        ----------
        data : bytes
            Of a PNG or JPEG file, at most 8 MB and 16 million pixels. The same bytes have the same
            name everywhere; `save_scene` puts pictures that are used beside the scene.

        Raises
        ------
        InvalidRequest, InvalidState
            If it is no such file, or 64 pictures have been sent already.
        """
        return core.library.pictures.add(data)

    def send_picture(self, picture: str | Path | BinaryIO | NDArray[np.uint8]) -> str:
        """Send a picture for materials; return the name that `set_material` takes.

        Parameters
        ----------
        picture : str, Path, binary file, or (H, W, 3) uint8
            A PNG or JPEG file, or red, green and blue.
        """
        if isinstance(picture, np.ndarray):
            if picture.dtype != np.uint8 or picture.ndim != 3 or picture.shape[2] != 3:
                shape = f"{picture.shape} {picture.dtype}"
                raise InvalidRequest("picture", shape, "an array (H, W, 3) of uint8")
            from PIL import Image

            file = io.BytesIO()
            Image.fromarray(picture).save(file, "PNG")
            return self.upload_picture(file.getvalue())
        if isinstance(picture, str | Path):
            try:
                return self.upload_picture(Path(picture).read_bytes())
            except OSError as problem:
                accepted = f"a file that can be read ({problem.strerror})"
                raise InvalidRequest("picture", str(picture), accepted) from None
        data = picture.read()
        if not isinstance(data, bytes):
            raise InvalidRequest("picture", picture, "a file that is open for bytes, not for text")
        return self.upload_picture(data)
