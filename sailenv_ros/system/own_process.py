"""Things that live in the process that made them: elsewhere they refuse to work, at once.

Threads do not exist in a fork, and locks that they held are held there forever.
"""

from __future__ import annotations

import os
from typing import Any, NoReturn

from sailenv_ros.errors import WrongProcess

__all__ = ["OwnProcess", "StaysInProcess"]


class OwnProcess:
    """The process in which something was made.

    Parameters
    ----------
    thing : str
        What it is, e.g. ``"Simulation"``.
    """

    def __init__(self, thing: str) -> None:
        self._thing = thing
        self._id = os.getpid()

    @property
    def is_inherited(self) -> bool:
        """True in a fork of that process."""
        return os.getpid() != self._id

    def require(self) -> None:
        """Refuse to work in a fork; to be called before any lock is taken.

        Raises
        ------
        WrongProcess
            If this is another process.
        """
        if self.is_inherited:
            raise WrongProcess(self._thing, made_in=self._id)


class StaysInProcess:
    """Base of what can be neither copied nor sent to another process."""

    def __reduce_ex__(self, protocol: Any) -> NoReturn:
        raise WrongProcess(type(self).__name__, made_in=os.getpid())
