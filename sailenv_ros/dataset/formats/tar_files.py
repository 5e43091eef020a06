"""Named contents → a tar file: nothing of the machine or the moment, so equal ones are equal bytes.

Written by hand rather than by `tarfile`, which copies every content through small blocks: large
arrays go to the file as they lie in memory.
"""

from __future__ import annotations

import tarfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.system.files import begin_write_back, write_errors

__all__ = ["Content", "TarWriter"]

WRITE_BACK_BYTES = 1 << 25
"""Number of bytes after which writing to the disk begins, so that little is left at the end."""

Content: TypeAlias = bytes | NDArray[Any]
"""An array stands for its bytes; it must be in C order."""


class TarWriter:
    """Writes the members of one tar file (POSIX ustar), one after another.

    Parameters
    ----------
    file : binary file
        Stays open.
    path : Path
        Its name, for errors.
    """

    def __init__(self, file: BinaryIO, path: Path) -> None:
        self._file = file
        self._path = path
        self._bytes = self._handed_on = 0

    def append(self, name: str, contents: Sequence[Content]) -> None:
        """Append a member that consists of these contents, one after another.

        Raises
        ------
        RecordingError
            If the file cannot be written.
        """
        member = tarfile.TarInfo(name)
        member.size = sum(
            one.nbytes if isinstance(one, np.ndarray) else len(one) for one in contents
        )
        member.mtime, member.mode = 0, 0o644
        self._write(member.tobuf(tarfile.USTAR_FORMAT))
        for one in contents:
            self._write(one)
        self._fill(tarfile.BLOCKSIZE)
        if self._bytes - self._handed_on >= WRITE_BACK_BYTES:
            self._handed_on = self._bytes
            begin_write_back(self._file.fileno())

    def finish(self) -> None:
        """Write the end of the file.

        Raises
        ------
        RecordingError
            If the file cannot be written.
        """
        self._write(bytes(2 * tarfile.BLOCKSIZE))
        self._fill(tarfile.RECORDSIZE)

    def _fill(self, block: int) -> None:
        self._write(bytes(-self._bytes % block))

    def _write(self, data: Content) -> None:
        view = memoryview(data) if isinstance(data, bytes) else data.reshape(-1).view(np.uint8).data
        with write_errors(self._path):
            self._file.write(view)
        self._bytes += len(view)
