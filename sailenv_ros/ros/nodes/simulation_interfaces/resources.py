"""Resources of requests to spawn: a URI or a text → an object or a robot as scene files have it."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote, unquote

from simulation_interfaces.msg import Result
from simulation_interfaces.srv import SpawnEntity

from sailenv_ros.errors import AssetError, AssetMissing, MissingPackage, SailenvError
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal, refused
from sailenv_ros.scene.entries import read_document
from sailenv_ros.simulation.operations.entity_operations import EntityOperations

__all__ = ["Spawned", "asset_uri", "spawn_formats", "spawned_by"]

ASSET_SCHEME = "sailenv://asset/"
"""Begin of the URI of an asset of the catalogue."""

FILE_SCHEME = "file://"

MOST_CHARACTERS = 64 * 1024
"""Length of an object or a robot as a scene file describes it; URDF and MJCF may be longer."""

Code = SpawnEntity.Response

UNREADABLE: dict[type[SailenvError], int] = {
    AssetMissing: Code.MISSING_ASSETS,
    MissingPackage: Code.UNSUPPORTED_FORMAT,
    AssetError: Code.RESOURCE_PARSE_ERROR,
}
"""Codes of robots that cannot be read."""

_ROBOT_FILE = re.compile(r".*\.(urdf|xml|mjcf)", re.IGNORECASE | re.DOTALL)
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _.-]{0,39}")


@dataclass(frozen=True, slots=True)
class Spawned:
    """An object or a robot to be spawned.

    Attributes
    ----------
    entry : mapping
        Keys of a scene file, but for its place.
    name : str
        The name that the resource has for it; empty for none.
    kind : str
        What names are made of where there is none.
    """

    entry: Mapping[str, Any]
    name: str
    kind: str

    @property
    def is_robot(self) -> bool:
        """True of a robot."""
        return "asset" not in self.entry


def asset_uri(name: str) -> str:
    """Return the URI of an asset."""
    return ASSET_SCHEME + quote(name)


def spawn_formats() -> list[str]:
    """Return the formats of resources: those of scene files, and of robots that can be read."""
    return ["sailenv", "urdf", *(["mjcf"] if importlib.util.find_spec("mujoco") else [])]


async def spawned_by(desk: Desk, uri: str, text: str) -> Spawned:
    """Return what a resource describes.

    Raises
    ------
    Refusal
        With the code of `SpawnEntity` that says why there is nothing.
    """
    if uri:
        return await _of_uri(desk, uri)
    if not text:
        raise Refusal(Code.NO_RESOURCE, "a uri or a resource_string must be given")
    if text.lstrip("\ufeff \t\r\n").startswith("<"):
        return await _robot(desk, {"file": await _kept(desk, text)})
    if len(text) > MOST_CHARACTERS:
        sentence = f"resource_string must have at most {MOST_CHARACTERS} characters"
        raise Refusal(Code.RESOURCE_PARSE_ERROR, sentence)
    try:
        entry = read_document(text)
    except SailenvError as problem:
        raise refused(problem, {SailenvError: Code.RESOURCE_PARSE_ERROR}) from None
    if isinstance(entry, Mapping) and isinstance(entry.get("file"), str) and "asset" not in entry:
        return await _robot(desk, entry)
    if not isinstance(entry, Mapping) or "asset" not in entry:
        accepted = (
            "URDF, MJCF, or an object or robot as in a scene file, with its asset or file, "
            "such as {asset: cube, mass: 2}"
        )
        raise Refusal(Code.UNSUPPORTED_FORMAT, f"resource_string must be {accepted}")
    asset = str(entry["asset"])
    return Spawned(entry, str(entry.get("name") or ""), asset.replace(":", "_"))


async def _of_uri(desk: Desk, uri: str) -> Spawned:
    if uri.startswith(ASSET_SCHEME):
        asset = unquote(uri.removeprefix(ASSET_SCHEME))
    elif _ROBOT_FILE.fullmatch(uri):
        file = unquote(uri.removeprefix(FILE_SCHEME)) if uri.startswith(FILE_SCHEME) else uri
        return await _robot(desk, {"file": file})
    elif "://" in uri or "/" in uri:
        accepted = (
            f"{ASSET_SCHEME}NAME, a NAME of the catalogue, or a file of URDF or MJCF by its path, "
            "file://, package:// or PACKAGE:path"
        )
        raise Refusal(Code.UNSUPPORTED_FORMAT, f"uri must be {accepted}, got {uri!r}")
    else:
        asset = uri
    return Spawned({"asset": asset}, "", asset.replace(":", "_"))


async def _kept(desk: Desk, text: str) -> str:
    try:
        return await desk.do(EntityOperations.sent_robot, text)
    except SailenvError as problem:
        raise refused(problem, UNREADABLE) from None


async def _robot(desk: Desk, entry: Mapping[str, Any]) -> Spawned:
    try:
        file = await desk.do(EntityOperations.robot_file, str(entry["file"]))
    except SailenvError as problem:
        raise refused(problem, {AssetMissing: Result.RESULT_NOT_FOUND}) from None
    try:
        known = await desk.do(EntityOperations.robot_name, file)
    except SailenvError as problem:
        raise refused(problem, UNREADABLE) from None
    told = known if _NAME.fullmatch(known) else ""
    name = str(entry.get("name") or told)
    return Spawned({**entry, "file": file}, name, told or "robot")
