"""The scene that a simulation begins with where none is asked for."""

from __future__ import annotations

import logging

from sailenv_ros.assets.folders import standard_pack_folder
from sailenv_ros.assets.sources import BUILD_COMMAND, installed_packs

__all__ = ["DEFAULT_SCENE", "SCENE_WITHOUT_FURNITURE", "default_scene"]

DEFAULT_SCENE = "room_01"
SCENE_WITHOUT_FURNITURE = "optical"

_log = logging.getLogger(__name__)


def default_scene() -> str:
    """Return the scene to begin with if none is asked for.

    `DEFAULT_SCENE`, or one without furniture where that has not been built, with a warning.
    """
    if any(pack.folder == standard_pack_folder() for pack in installed_packs()):
        return DEFAULT_SCENE
    _log.warning(
        "beginning with the scene %s, because %s needs the furniture; fetch it with: %s",
        SCENE_WITHOUT_FURNITURE,
        DEFAULT_SCENE,
        BUILD_COMMAND,
    )
    return SCENE_WITHOUT_FURNITURE
