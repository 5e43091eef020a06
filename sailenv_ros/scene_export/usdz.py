"""Files in a usdz package: a zip without compression whose files begin at multiples of 64 bytes.

Pixar, "Usdz File Format Specification" 1.3.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping

__all__ = ["usdz_bytes"]

ALIGNMENT = 64

_LOCAL_HEAD_BYTES = 30
_FIELD_HEAD_BYTES = 4
_FIELD_ID = 0x1986
"""Of the field that fills the space before a file, as USD's own writer has it."""


def usdz_bytes(files: Mapping[str, bytes]) -> bytes:
    """Return a package; the first file is the layer that is opened."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_STORED, allowZip64=False) as package:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.external_attr = 0o644 << 16
            begins = made.tell() + _LOCAL_HEAD_BYTES + len(name.encode()) + _FIELD_HEAD_BYTES
            padding = -begins % ALIGNMENT
            head = _FIELD_ID.to_bytes(2, "little") + padding.to_bytes(2, "little")
            entry.extra = head + bytes(padding)
            package.writestr(entry, data)
    return made.getvalue()
