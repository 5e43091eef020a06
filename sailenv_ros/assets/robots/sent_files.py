"""Descriptions of robots that clients send as texts: kept as files, which scenes can name.

Meshes that such a text names are looked for in packages, by ``package://``.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from sailenv_ros.assets.safe_xml import read_xml
from sailenv_ros.errors import AssetError
from sailenv_ros.system.files import write_file
from sailenv_ros.system.user_folders import data_folder, remove_oldest

__all__ = ["MOST_CHARACTERS", "keep_description"]

MOST_CHARACTERS = 4 * 2**20
"""Length of a text that is kept."""

MOST_KEPT_BYTES = 256 * 2**20
"""Bytes of all texts that are kept; the oldest go."""

SUFFIXES = {"robot": ".urdf", "mujoco": ".xml"}


def keep_description(text: str) -> Path:
    """Write the text of a URDF or MJCF file to the user's folder; return where it is.

    The same text is the same file.

    Raises
    ------
    AssetError
        If it is neither, malformed or too long.
    """
    if len(text) > MOST_CHARACTERS:
        raise AssetError("robot", f"its text must have at most {MOST_CHARACTERS} characters")
    data = text.encode("utf-8", "replace")
    root = read_xml(data, "robot")
    if root.tag not in SUFFIXES:
        accepted = f"it must begin with <robot> or <mujoco>, and begins <{root.tag[:40]}>"
        raise AssetError("robot", accepted)
    folder = data_folder() / "robots"
    folder.mkdir(parents=True, exist_ok=True)
    digest = hashlib.blake2b(data, digest_size=10).hexdigest()
    path = folder / f"{digest}{SUFFIXES[root.tag]}"
    write_file(path, data, durable=False)
    remove_oldest(folder.iterdir(), most_bytes=MOST_KEPT_BYTES)
    return path
