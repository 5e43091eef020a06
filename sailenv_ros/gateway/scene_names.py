"""Names of scenes as clients of SAILenv know them, and ours; nothing else."""

from __future__ import annotations

from sailenv_ros.errors import UnknownName
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["scene_of_wire", "wire_scenes"]

_SCENE_SUFFIX = "/scene"


def wire_scenes(info: SceneInfo) -> list[str]:
    """Return the scenes' names as clients know them: ``room_01/scene``."""
    return [f"{name}{_SCENE_SUFFIX}" for name in info.scenes]


def scene_of_wire(name: str, info: SceneInfo) -> str:
    """Return our name of a scene; a client may leave the ``/scene`` out.

    Raises
    ------
    UnknownName
        If there is none, with the names that clients know.
    """
    ours = name.removesuffix(_SCENE_SUFFIX)
    if ours not in info.scenes:
        raise UnknownName("scene", name, wire_scenes(info))
    return ours
