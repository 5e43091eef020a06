"""What a user asks about the camera's picture: exposure, tone curve, effects, noise.

Part of `Agent`. Concerns the ``rgb`` view alone: no ground truth depends on it.
"""

from __future__ import annotations

from typing import Any

from sailenv_msgs.srv import GetPicture, SetPicture
from sailenv_msgs_py.pictures import picture_from_msg, picture_to_msg
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.picture_settings import PictureSettings

__all__ = ["PictureRequests"]


class PictureRequests:
    """Requests about an agent's picture; see `Agent`."""

    def _call_own(self, srv_type: Any, service: str, request: Any) -> Any:
        """Ask a service of this agent; give its answer, which says success."""
        raise NotImplementedError

    @property
    def picture(self) -> PictureSettings:
        """What is done to the picture now; the simulator is asked."""
        answer = self._call_own(GetPicture, "get_picture", GetPicture.Request())
        return picture_from_msg(answer.picture)

    def set_picture(
        self, settings: PictureSettings | None = None, /, **changes: Any
    ) -> PictureSettings:
        """Change the picture from the next frame on, also after a reset.

        Parameters
        ----------
        settings : PictureSettings or None
            All of them at once; None leaves what `changes` do not name.
        **changes
            Some of them by their names in `PictureSettings`.

        Returns
        -------
        settings : PictureSettings
            As they are then.

        >>> agent.set_picture(exposure=1.0, bloom=0.1)  # doctest: +SKIP
        """
        given: object = PictureSettings() if settings is None else settings
        if not isinstance(given, PictureSettings):
            raise InvalidRequest("settings", given, "an object of PictureSettings")
        # Where none are given, those that are not named are not looked at.
        wanted = given.changed(changes)
        if settings is None and not changes:
            return self.picture
        fields = list(changes) if settings is None else []
        request = SetPicture.Request(picture=picture_to_msg(wanted), fields=fields)
        return picture_from_msg(self._call_own(SetPicture, "set_picture", request).picture)
