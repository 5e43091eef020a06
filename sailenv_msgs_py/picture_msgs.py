"""`PictureSettings` to and from its message, whose fields have the settings' names."""

from __future__ import annotations

import sailenv_msgs.msg as msgs
from sailenv_ros.types.picture_settings import NAMES, PictureSettings

__all__ = ["picture_from_msg", "picture_to_msg"]


def picture_to_msg(settings: PictureSettings) -> msgs.PictureSettings:
    """Make the message."""
    return msgs.PictureSettings(**{name: getattr(settings, name) for name in NAMES})


def picture_from_msg(msg: msgs.PictureSettings) -> PictureSettings:
    """Read all settings.

    Raises
    ------
    InvalidRequest, UnknownName
        If one of them is out of its range.
    """
    return PictureSettings(**{name: getattr(msg, name) for name in NAMES})
