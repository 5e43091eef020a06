"""`PictureSettings` to and from its message, whose fields have the settings' names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sailenv_msgs.msg as msgs
from sailenv_ros.errors import UnknownName
from sailenv_ros.picture_settings import NAMES, PictureSettings

__all__ = ["picture_changes_from_msg", "picture_from_msg", "picture_to_msg"]


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
    return PictureSettings(**picture_changes_from_msg(msg, NAMES))


def picture_changes_from_msg(msg: msgs.PictureSettings, fields: Iterable[str]) -> dict[str, Any]:
    """Read those settings that are to be taken over; none named means all.

    Raises
    ------
    UnknownName
        If a field is no setting.
    """
    wanted = tuple(fields) or NAMES
    for field in wanted:
        if field not in NAMES:
            raise UnknownName("field of a picture's settings", field, NAMES)
    return {field: getattr(msg, field) for field in wanted}
