"""Files of robots → `RobotModel`s, each read once; their links are assets of the catalogue.

An asset of a link is called ``robot:FILE:DIGEST#LINK``; it is found once the file was read.
"""

from __future__ import annotations

import hashlib
import importlib.util
import re
import threading
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from sailenv_ros.assets.archives import MAX_ARCHIVE_BYTES
from sailenv_ros.assets.robots.assembling import assembled
from sailenv_ros.assets.robots.mesh_paths import PACKAGE, package_path
from sailenv_ros.assets.robots.mjcf_file import read_mjcf
from sailenv_ros.assets.robots.urdf_file import described, mount_of, read_urdf
from sailenv_ros.assets.safe_xml import read_xml
from sailenv_ros.errors import AssetError, AssetMissing, UnknownName
from sailenv_ros.types.model import Asset
from sailenv_ros.types.robots import LINK_ASSETS, Mount, RobotModel

__all__ = ["RobotStore", "is_of_package", "robot_path"]

_PACKAGE = re.compile(r"([A-Za-z_][A-Za-z0-9_]*):(?!//)(.+)")
_LINK = re.compile(r"[A-Za-z0-9 _.-]+")
_LONGEST_LINK = 40


def is_of_package(file: str) -> bool:
    """Return whether a file is named by the Python package that has it."""
    return _PACKAGE.fullmatch(file) is not None


def robot_path(file: str, beside: Path | None = None) -> Path:
    """Find the file of a robot.

    Parameters
    ----------
    file : str
        A path; ``PACKAGE:path``, a file of an installed Python package such as
        ``pybullet_data:franka_panda/panda.urdf``; or ``package://NAME/path``, one of ROS.
    beside : Path or None
        Folder from which paths are looked for first.

    Raises
    ------
    AssetMissing
        If it is not there.
    """
    found = _PACKAGE.fullmatch(file)
    if found:
        package = importlib.util.find_spec(found[1])
        for folder in (package and package.submodule_search_locations) or ():
            home = Path(str(folder)).resolve()
            path: Path = (home / str(found[2])).resolve()
            if path.is_relative_to(home) and path.is_file():
                return path
        why = f"the Python package {found[1]!r} is not installed, or has no such file"
        raise AssetMissing(file[:200], why)
    if file.startswith(PACKAGE):
        return package_path(file)
    for path in (*(() if beside is None else (beside / file,)), Path(file)):
        if "\0" not in file and path.is_file():
            return path.resolve()
    raise AssetMissing(file[:200], "there is no such file")


class RobotStore:
    """Robots that were read, a source of assets; may be used from several threads."""

    def __init__(self) -> None:
        self._models: dict[str, RobotModel] = {}
        self._assets: dict[str, Asset] = {}
        self._lock = threading.Lock()

    @property
    def display_names(self) -> Mapping[str, str]:
        """Nothing: links are not listed, as they stand in no catalogue."""
        return MappingProxyType({})

    def speaks_of(self, name: str) -> bool:
        """Return whether a name is that of a link."""
        return name.startswith(LINK_ASSETS)

    def load(self, name: str) -> Asset:
        """Return the asset of a link.

        Raises
        ------
        UnknownName
            If its file has not been read.
        """
        problem = self.problem(name)
        if problem is not None:
            raise problem
        return self._assets[name]

    def sibling(self, name: str, seed: int) -> str | None:
        """Return None: no seed makes another of a kind."""
        return None

    def problem(self, name: str) -> UnknownName | None:
        """Return why there is no such link; None if there is."""
        return None if name in self._assets else UnknownName("link of a robot", name, self._assets)

    def find(self, file: str) -> RobotModel:
        """Return the robot of a file by what `robot_path` takes; see it and `read` for errors."""
        return self.read(robot_path(file))

    def read(self, path: Path) -> RobotModel:
        """Return the robot of a file; the same object while its bytes are the same.

        Raises
        ------
        AssetError
            If it is malformed, too large or malicious.
        MissingPackage
            If it is MJCF, and MuJoCo is not installed.
        """
        if path.stat().st_size > MAX_ARCHIVE_BYTES:
            raise AssetError(path.name, f"it is larger than {MAX_ARCHIVE_BYTES // 2**20} MB")
        data = path.read_bytes()
        digest = hashlib.blake2b(data + str(path).encode(), digest_size=5).hexdigest()
        stem = re.sub(r"[^A-Za-z0-9_.-]", "_", path.stem)[:20]
        key = f"{LINK_ASSETS}{stem}:{digest}"
        with self._lock:
            model = self._models.get(key)
        if model is None:
            model = _read(path, data, key)
            with self._lock:
                self._models[key] = model
                self._assets.update({link.asset.name: link.asset for link in model.links})
        return model


def _read(path: Path, data: bytes, key: str) -> RobotModel:
    root = read_xml(data, path.name)
    start: dict[str, float] = {}
    mount: Mount = "fixed"
    text = ""
    if root.tag == "robot":
        links, joints = read_urdf(root, path)
        mount = mount_of(root)
        text = described(data.decode("utf-8-sig", "replace"), path)
    elif root.tag == "mujoco":
        content = read_mjcf(path)
        links, joints = content.links, content.joints
        mount, start = content.mount, content.start
    else:
        raise AssetError(
            root.place, f"it must begin with <robot> or <mujoco>, and begins <{root.tag[:40]}>"
        )
    for link in links:
        if len(link.name) > _LONGEST_LINK or not _LINK.fullmatch(link.name):
            accepted = (
                f"up to {_LONGEST_LINK} letters, digits, spaces, '_', '-' and '.' are accepted"
            )
            raise AssetError(
                link.place or path.name, f"a link is called {link.name[:80]!r}; {accepted}"
            )
    name = root.text("name") or root.text("model") or path.stem
    model = assembled(name[:60], links, joints, file=path.name, key=key)
    return replace(model, description=text, mount=mount, start=start)
