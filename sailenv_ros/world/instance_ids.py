"""Instance ids, given once and never again, and the number of the history of each."""

from __future__ import annotations

from sailenv_ros.errors import InvalidState
from sailenv_ros.types.labels import MAX_INSTANCE_ID

__all__ = ["InstanceIds"]


class InstanceIds:
    """Gives ids 1, 2, 3 …, and counts the histories of what has them.

    Attributes
    ----------
    last : int
        The greatest id that was given.
    histories : dict of int to int
        Number of the present history of each id that is in use.
    """

    def __init__(self) -> None:
        self.last = 0
        self.histories: dict[int, int] = {}
        self._last_history = 0

    def require(self, count: int) -> None:
        """Refuse what needs more ids than are left.

        Raises
        ------
        InvalidState
        """
        if self.last + count > MAX_INSTANCE_ID:
            raise InvalidState(
                f"a scene can have {MAX_INSTANCE_ID} objects in its life and has had them; "
                "reset the scene to begin anew"
            )

    def take(self, count: int) -> tuple[int, ...]:
        """Give the next ids; see `require` for errors."""
        self.require(count)
        self.last += count
        return tuple(range(self.last - count + 1, self.last + 1))

    def begin_history(self, instance_id: int) -> None:
        """Begin a new history: flow does not see where the body was before."""
        self._last_history += 1
        self.histories[instance_id] = self._last_history
