"""The bodies of a world by their instance ids, which are given once and never again.

Knows neither time nor lights: what is changed here, `World` tells.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, InvalidState, NameTaken, UnknownName
from sailenv_ros.instance_states import InstanceStates
from sailenv_ros.labels import MAX_INSTANCE_ID
from sailenv_ros.validation import is_integer
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.placement import Placement

__all__ = ["BodyTable"]


class BodyTable:
    """The bodies that there are, in the order of their ids.

    Parameters
    ----------
    client : BulletClient
        The engine that they live in.
    placements : iterable of Placement
        What is there from the start; get the ids 1, 2, 3 … in this order.
    """

    def __init__(
        self,
        client: BulletClient,
        placements: Iterable[Placement],
    ) -> None:
        self._client = client
        self._bodies: dict[int, Body] = {}
        self._histories: dict[int, int] = {}
        self._last_id = 0
        self._last_history = 0
        for placement in placements:
            self.add(placement)
        self._first_names = {id_: body.placement.name for id_, body in self._bodies.items()}
        self._room_parts = frozenset(
            body.placement.name for body in self if body.placement.entry is None
        )

    def __iter__(self) -> Iterator[Body]:
        return iter(self._bodies.values())

    def __getitem__(self, instance_id: int) -> Body:
        """Find the body of an instance.

        Raises
        ------
        InvalidRequest
            If no instance has that id now.
        """
        if instance_id not in self._bodies:
            raise InvalidRequest("instance id", instance_id, "the id of an object in the scene")
        return self._bodies[instance_id]

    def items(self) -> Iterable[tuple[int, Body]]:
        """Return ids and bodies."""
        return self._bodies.items()

    def find(self, obj: int | str) -> int:
        """Return the instance id of an object that is named by its id, also as a text, or its name.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such object now.
        """
        if is_integer(obj):
            self[int(obj)]
            return int(obj)
        if not isinstance(obj, str):
            raise InvalidRequest("object", obj, "an instance id, or the name of an object")
        ids = {body.placement.name: id_ for id_, body in self._bodies.items()}
        if obj in ids:
            return ids[obj]
        if obj.isdecimal() and int(obj) in self._bodies:
            return int(obj)  # scripts of the SAILenv client hold ids as texts
        raise UnknownName("object", obj, ids)

    def id_of_name(self, name: str) -> int:
        """Return the instance id of the object of that name; 0 if there is none."""
        return next((id_ for id_, body in self.items() if body.placement.name == name), 0)

    @property
    def firsts(self) -> Mapping[str, Body]:
        """The bodies of the start that are still there, by the names that they had then."""
        named = self._first_names.items()
        return {name: self._bodies[id_] for id_, name in named if id_ in self._bodies}

    @property
    def missing_room_parts(self) -> frozenset[str]:
        """Names of the parts of the room that were there at the start and are no more."""
        return self._room_parts.difference(body.placement.name for body in self)

    def world_from_body(self) -> NDArray[np.float64]:
        """Return the (N, 4, 4) poses now."""
        rows = [body.world_from_body() for body in self]
        return np.stack(rows) if rows else np.zeros((0, 4, 4))

    def states(self, world_from_body: NDArray[np.float64]) -> InstanceStates:
        """Return where the bodies are and how they move, at poses (N, 4, 4) that were just read."""
        quats = [body.orientation_of_matrix() for body in self]
        moving = [
            body.origin_velocity(matrix) for body, matrix in zip(self, world_from_body, strict=True)
        ]
        velocities = np.array(moving, np.float64).reshape(-1, 2, 3)
        return InstanceStates(
            ids=np.array(list(self._bodies), np.uint16),
            positions=world_from_body[:, :3, 3],
            orientations=np.array(quats, np.float64).reshape(-1, 4),
            linear_velocities=velocities[:, 0],
            angular_velocities=velocities[:, 1],
            scales=np.array([body.placement.scale for body in self], np.float64).reshape(-1, 3),
            histories=self.histories(),
        )

    def histories(self) -> NDArray[np.int64]:
        """Return (N,) numbers; a body's past before its number changed has been cut off."""
        return np.array([self._histories[id_] for id_ in self._bodies], dtype=np.int64)

    def add(self, placement: Placement) -> int:
        """Put a body into the engine; return its instance id.

        Raises
        ------
        NameTaken, InvalidRequest
            If there is one of that name, or no id is left.
        """
        self._require_free_name(placement.name)
        self._require_ids(1)
        body = Body(self._client, placement)
        self._last_id += 1
        self._bodies[self._last_id] = body
        self.cut_off_past(self._last_id)
        return self._last_id

    def remove(self, instance_id: int) -> None:
        """Take a body out of the engine, and wake what rests upon it."""
        gone = self[instance_id]
        self.rouse_beside(gone)
        gone.remove()
        del self._bodies[instance_id]
        del self._histories[instance_id]

    def rebuild(self, instance_id: int, placement: Placement) -> None:
        """Make of a body what another placement says; it keeps its id, its place, its motion.

        Raises
        ------
        NameTaken, InvalidRequest
            If another has that name, or it cannot be such a body; it is as it was then.
        """
        old = self[instance_id]
        if placement.name != old.placement.name:
            self._require_free_name(placement.name)
        new = old.rebuilt(placement)
        self.rouse_beside(old)
        old.remove()
        self._bodies[instance_id] = new

    def replace_room(self, placements: Iterable[Placement], without: Collection[int] = ()) -> None:
        """Exchange all parts of the room; a part of the same name keeps its id.

        Parameters
        ----------
        placements : iterable of Placement
            The parts that there shall be.
        without : collection of int
            Ids of objects that go with the present parts.

        Raises
        ------
        NameTaken, InvalidState
            If another object has the name of a part, or no ids are left; nothing is changed then.
        """
        parts = {b.placement.name: id_ for id_, b in self.items() if b.placement.entry is None}
        wanted, leaving = list(placements), {*parts.values(), *without}
        others = {body.placement.name for id_, body in self.items() if id_ not in leaving}
        for placement in wanted:
            if placement.name in others:
                raise NameTaken("object", placement.name)
        self._require_ids(sum(placement.name not in parts for placement in wanted))
        made: list[Body] = []
        try:
            for placement in wanted:
                made.append(Body(self._client, placement))
        except BaseException:
            for body in made:
                body.remove()
            raise
        for id_ in leaving:
            self._bodies[id_].remove()
        for body in made:
            id_ = parts.get(body.placement.name, 0)
            if not id_:
                self._last_id += 1
                id_ = self._last_id
            self._bodies[id_] = body
            self.cut_off_past(id_)
            leaving.discard(id_)
        for id_ in leaving:
            del self._bodies[id_], self._histories[id_]
        self._room_parts = frozenset(placement.name for placement in wanted)

    def rouse_beside(self, body: Body) -> None:
        """Wake what sleeps beside or upon a body that is about to leave its place."""
        touching = body.touching_ids()
        for other in self:
            if other is not body and other.bullet_id in touching:
                other.wake()

    def cut_off_past(self, instance_id: int) -> None:
        """Begin a new history: flow does not see where the body was before."""
        self._last_history += 1
        self._histories[instance_id] = self._last_history

    def _require_free_name(self, name: str) -> None:
        if any(body.placement.name == name for body in self):
            raise NameTaken("object", name)

    def _require_ids(self, count: int) -> None:
        if self._last_id + count > MAX_INSTANCE_ID:
            raise InvalidState(
                f"a scene can have {MAX_INSTANCE_ID} objects in its life and has had them; "
                "reset the scene to begin anew"
            )
