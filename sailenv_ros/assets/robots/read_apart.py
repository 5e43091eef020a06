"""URDF and MJCF files read by MuJoCo in a process of its own.

After a look at what the file names: only files beside it, and nothing that grows without end.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.safe_xml import XmlNode, read_xml
from sailenv_ros.errors import AssetError

__all__ = ["ANSWER", "checked_tree", "read_apart", "run_reader"]

ANSWER = "scene.json"
"""File that a reader writes last."""

LIMIT_S = 120.0
MEMORY_BYTES = 4 * 2**30
MOST_FILES = 50

GROWING = ("replicate", "composite", "flexcomp", "plugin", "size")
"""Elements that make many out of few, or run what is not in the file."""

FILE_KEYS = (
    *("file", "filename", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback"),
    *("meshdir", "texturedir", "assetdir"),
)


def checked_tree(path: Path) -> XmlNode:
    """Read the tree of a file and of those that it includes; refuse what leads elsewhere.

    Raises
    ------
    AssetError
        If it is malformed or malicious.
    """
    home = path.resolve().parent
    first: XmlNode | None = None
    waiting, seen = [path.resolve()], {path.resolve()}
    while waiting:
        file = waiting.pop()
        root = read_xml(file.read_bytes(), file.name)
        if first is None:
            first = root
            if root.tag not in ("robot", "mujoco"):
                raise AssetError(
                    root.place, f"it must begin with <robot> or <mujoco>, and begins <{root.tag}>"
                )
        for node in root.walk():
            if node.tag in GROWING:
                raise AssetError(node.place, f"the element <{node.tag}> is not read")
            for key in FILE_KEYS:
                named = node.text(key)
                plain = named.removeprefix("package://").removeprefix("file://")
                if named and (plain != named or not _beside(home, plain)):
                    raise AssetError(node.place, f"it names {named[:80]!r}, which is not beside it")
            if node.tag == "include" and node.text("file"):
                other = (home / node.text("file")).resolve()
                if other not in seen and other.is_file():
                    if len(seen) >= MOST_FILES:
                        raise AssetError(node.place, f"it includes more than {MOST_FILES} files")
                    seen.add(other)
                    waiting.append(other)
    assert first is not None
    return first


def _beside(home: Path, name: str) -> bool:
    return "\0" not in name and (home / name).resolve().is_relative_to(home)


def read_apart(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]]:
    """Return what MuJoCo tells of a file that was checked: a description and arrays of meshes.

    Raises
    ------
    AssetError
        If MuJoCo cannot read it, or not in the time and memory that it is given.
    """
    with tempfile.TemporaryDirectory(prefix="sailenv-import-") as name:
        folder = Path(name)
        run_reader("sailenv_content.scene_import.robot_reader", "MuJoCo", path, folder)
        read = json.loads((folder / ANSWER).read_text(encoding="utf-8"))
        with np.load(folder / "arrays.npz", allow_pickle=False) as file:
            return read, {key: np.asarray(file[key], np.float64) for key in file.files}


def run_reader(module: str, reader: str, path: Path, folder: Path) -> None:
    """Have a file read in a process of its own, with so much time and memory.

    Parameters
    ----------
    module : str
        Gets the file, the folder and the bytes of memory. Writes `ANSWER`, or ``refused.txt``.
    reader : str
        Whose reader it is, for errors.
    path, folder : Path
        The file, and where the answer goes.

    Raises
    ------
    AssetError
        If it cannot be read so.
    """
    command = [sys.executable, "-m", module, str(path.resolve()), str(folder), str(MEMORY_BYTES)]
    package = str(Path(__file__).resolve().parents[3])
    paths = [package, *filter(None, [os.environ.get("PYTHONPATH")])]
    try:
        done = subprocess.run(
            command,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
            capture_output=True,
            timeout=LIMIT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise AssetError(path.name, f"reading it took longer than {LIMIT_S:g} s") from None
    refused = folder / "refused.txt"
    if refused.is_file():
        raise AssetError(path.name, f"{reader} cannot read it: {refused.read_text('utf-8')}")
    if done.returncode or not (folder / ANSWER).is_file():
        raise AssetError(path.name, "its reader ended; it may be damaged, or too large")
