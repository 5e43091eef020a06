"""Objects that are nowhere for now: neither in the engine nor in any table, but their ids are kept.

A body goes in when it leaves the world, and a placement comes out for when it enters again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from sailenv_ros.behaviours import RunningBehaviour, start_behaviour
from sailenv_ros.errors import InvalidState
from sailenv_ros.types.labels import PART_MARK
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.placement import Placement

__all__ = ["InactiveObjects"]

Kinds = tuple[tuple[str, Mapping[str, Any]], ...]


class InactiveObjects:
    """The objects that wait, by their instance ids."""

    def __init__(self) -> None:
        self._placements: dict[int, Placement] = {}
        self._kinds: dict[int, Kinds] = {}

    def __contains__(self, instance_id: object) -> bool:
        return instance_id in self._placements

    def __getitem__(self, instance_id: int) -> Placement:
        return self._placements[instance_id]

    def __iter__(self) -> Iterator[int]:
        return iter(sorted(self._placements))

    def names(self) -> Mapping[str, int]:
        """Return the ids by the names of the objects."""
        return {self._placements[id_].name: id_ for id_ in self}

    def take(self, instance_id: int, placement: Placement) -> None:
        """Keep an object that has not been there yet, or that is another now."""
        self._placements[instance_id] = placement
        entry = placement.entry
        behaviours = () if entry is None else entry.behaviours
        self._kinds[instance_id] = tuple((b.type, b.parameters) for b in behaviours)

    def take_back(self, instance_id: int, body: Body) -> None:
        """Keep an object that has just left; it will enter where and as it did before."""
        placement = body.placement
        entry = placement.entry
        assert entry is not None  # parts of a room never leave
        self._placements[instance_id] = replace(
            placement,
            pose=body.entry_pose,
            linear_velocity=entry.velocity,
            angular_velocity=entry.angular_velocity_rad_s,
            behaviours=(),
        )
        self._kinds[instance_id] = tuple(
            (running.kind.type, running.parameters.model_dump(mode="json", exclude_unset=True))
            for running in body.behaviours
        )

    def give(self, instance_id: int, *, seed: int, start_s: float) -> Placement:
        """Let an object go, with its behaviours beginning at a simulated time [s]."""
        placement = self._placements[instance_id]
        running: list[RunningBehaviour] = [
            start_behaviour(
                type_,
                parameters,
                seed=seed,
                object_name=placement.name,
                place=place,
                start_s=start_s,
            )
            for place, (type_, parameters) in enumerate(self._kinds[instance_id])
        ]
        self.forget(instance_id)
        return replace(placement, behaviours=tuple(running))

    def forget(self, instance_id: int) -> None:
        """Let an object go for good."""
        del self._placements[instance_id], self._kinds[instance_id]

    def refuse(self, obj: int | str) -> None:
        """Refuse to find an object, or a part of one, that waits.

        Raises
        ------
        InvalidState
            If it does.
        """
        for id_, placement in self._placements.items():
            name = placement.name
            if obj in (id_, name, str(id_)) or str(obj).startswith(f"{name}{PART_MARK}"):
                raise InvalidState(
                    f"object {name!r} is not there now: it comes and goes with the lessons of the "
                    "scene, or has left"
                )
