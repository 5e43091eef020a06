"""Tables with a row for each object of an instant, which is found by its id."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest

__all__ = ["RowsById"]


class RowsById:
    """The part of a table that finds rows; the table has the column `ids`, (N,) uint16."""

    ids: NDArray[np.uint16]

    def row(self, instance_id: int) -> int:
        """Return the row of an object.

        Raises
        ------
        InvalidRequest
            If there was none of that id.
        """
        if instance_id not in self._rows:
            accepted = "the id of an object that there was at this instant"
            raise InvalidRequest("instance id", instance_id, accepted)
        return self._rows[instance_id]

    @cached_property
    def _rows(self) -> dict[int, int]:
        return {id_: row for row, id_ in enumerate(self.ids.tolist())}
