"""The operation that draws a scene again at random."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.entries import read_document
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import BeginsScenes

__all__ = ["ChanceOperations"]


def _things(what: str, value: object) -> Any:
    if isinstance(value, str):
        value = read_document(value)
    if value is not None and not isinstance(value, list | tuple):
        raise InvalidRequest(what, value, "a list, as under randomise in a scene file")
    return value


class ChanceOperations(Caller):
    """Randomisation of the scene; see `randomise` in scene files."""

    @operation(
        deadline_s=120.0,
        seed=check.optional(check.seed),
        index=check.optional(check.seed),
        things=_things,
    )
    @staticmethod
    def randomise(
        core: BeginsScenes,
        seed: int | None = None,
        *,
        index: int | None = None,
        things: Sequence[Mapping[str, Any]] | str | None = None,
        record: Mapping[str, Any] | str | None = None,
    ) -> dict[str, Any]:
        """Begin the present scene again with values drawn at random; return the record of them.

        The same scene, seed and index give the same values. `reset` begins an epoch again with
        the values that it has, or with those of another seed.

        Parameters
        ----------
        seed : int or None
            0 or more; None keeps the present one.
        index : int or None
            Which of the seed's epochs; None takes 0 where a seed is given, else the next one.
        things : sequence of mapping, str or None
            What is drawn, as the list under `randomise` in a scene file, or its YAML or JSON text;
            None leaves it as it is. They hold until the scene is changed.
        record : mapping, str or None
            What `Frame.randomised` told of a frame, to have its values again, with its seed and
            index. After ``step(record["step"])``, if that is not 0, the frame is the same again.

        Returns
        -------
        record : dict
            ``seed``, ``index``, ``step``, and the values of the ``epoch`` and of the ``frame``.

        Raises
        ------
        InvalidState
            If the scene draws nothing and no things are given.
        InvalidRequest, InvalidEntry
            If it cannot be drawn; the scene continues as it was then.

        >>> agent.randomise(seed=3)  # doctest: +SKIP
        """
        return core.randomise_now(seed, index, things, record)
