"""The bodies of a world by their instance ids, which are given once and never again.

Knows neither time nor lights: what is changed here, `World` tells.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, NameTaken
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.types.validation import is_integer
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.inactive_objects import InactiveObjects
from sailenv_ros.world.instance_ids import InstanceIds
from sailenv_ros.world.joint_table import JointTable
from sailenv_ros.world.jointed_bodies import make_bodies, make_body
from sailenv_ros.world.labelled_pieces import LabelledPiece, find_piece, pieces_of, states_of
from sailenv_ros.world.last_poses import LastPoses
from sailenv_ros.world.person_body import deformations_of, skeletons_of
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.repainting import repaint

__all__ = ["BodyTable"]


class BodyTable:
    """The bodies that there are, in the order of their ids, and the labelled parts of each.

    Parameters
    ----------
    client : BulletClient
        The engine that they live in.
    placements : iterable of Placement
        What is there from the start; get the ids 1, 2, 3 … in this order. Parts of their models
        get the ids that follow, and after them what lies outside.
    waiting : collection of str
        Names of those that are nowhere at first.

    Attributes
    ----------
    waiting : InactiveObjects
        Objects that are nowhere now.
    others : callable
        Returns bodies that are in the engine too, and no objects.
    """

    def __init__(
        self,
        client: BulletClient,
        placements: Iterable[Placement],
        waiting: Collection[str] = (),
    ) -> None:
        self._client = client
        self.waiting = InactiveObjects()
        self.others: Callable[[], Iterable[Body]] = tuple
        self.joints = JointTable(client)
        self._bodies: dict[int, Body] = {}
        self._parts: dict[int, tuple[int, ...]] = {}
        self._pieces: tuple[LabelledPiece, ...] | None = None
        self._ids = InstanceIds()
        self._last_poses = LastPoses()
        listed = list(placements)
        for placement in (one for one in listed if one.outside is None):
            self._add_body(placement, waits=placement.name in waiting)
        self.joints.arrange(self)
        for body_id in range(1, self._ids.last + 1):
            self._number_parts(body_id)
        for placement in (one for one in listed if one.outside is not None):
            self._add_body(placement)
        self._first_names = {id_: body.placement.name for id_, body in self._bodies.items()}
        self._room_parts = frozenset(
            body.placement.name for body in self if body.placement.entry is None
        )

    def __iter__(self) -> Iterator[Body]:
        return iter(self._bodies.values())

    def __getitem__(self, instance_id: int) -> Body:
        """Find the body of an object.

        Raises
        ------
        InvalidRequest
            If no object has that id now, also if a part of one has it.
        """
        if instance_id in self._bodies:
            return self._bodies[instance_id]
        piece = self.piece(instance_id)
        whole = piece.body.placement.name
        accepted = f"an object of its own; this goes with {whole!r}, of which it is a part"
        raise InvalidRequest("object", piece.name, accepted)

    def piece(self, instance_id: int) -> LabelledPiece:
        """Find what an instance id stands for; one that no instance has now is refused."""
        return find_piece(self.pieces, instance_id)

    def items(self) -> Iterable[tuple[int, Body]]:
        """Return ids and bodies."""
        return self._bodies.items()

    @property
    def pieces(self) -> tuple[LabelledPiece, ...]:
        """Bodies and parts, in the order of their ids: a row of labels for each."""
        if self._pieces is None:
            self._pieces = pieces_of(self._bodies, self._parts)
        return self._pieces

    def ids_of(self, body_id: int) -> tuple[int, ...]:
        """Return the ids of a body and its parts."""
        return (body_id, *self._parts[body_id])

    def find(self, obj: int | str) -> int:
        """Return the instance id of what is named by its id, also as a text, or its name.

        Parts are found too, as ``bed/left pillow``.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such object now.
        """
        if is_integer(obj) or isinstance(obj, str):
            self.waiting.refuse(obj if isinstance(obj, str) else int(obj))
        return find_piece(self.pieces, obj).id

    def id_of_name(self, name: str) -> int:
        """Return the instance id of the object of that name; 0 if there is none."""
        return next((id_ for id_, body in self.items() if body.placement.name == name), 0)

    def name_of(self, body_id: int) -> str:
        """Return the name of a body that is there or waits; empty if it is gone for good."""
        if body_id in self.waiting:
            return self.waiting[body_id].name
        return self._bodies[body_id].placement.name if body_id in self._bodies else ""

    def last_world_from_body(self, body_id: int) -> NDArray[np.float64]:
        """Return the (4, 4) pose of a body now, or as it was when it left or was removed.

        Of one that has not been there yet, where it will be.
        """
        return self._last_poses.of(body_id, self._bodies.get(body_id), self.waiting)

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
        """Return the (N, 4, 4) poses now, a row for each of `pieces`."""
        poses = {body_id: body.world_from_body() for body_id, body in self._bodies.items()}
        rows = [poses[piece.body_id] for piece in self.pieces]
        return np.stack(rows) if rows else np.zeros((0, 4, 4))

    def states(self, snapshot: WorldSnapshot) -> InstanceStates:
        """Return where all pieces are and how they move, by a snapshot that was just made."""
        return states_of(self.pieces, snapshot, skeletons_of(self._bodies))

    def deformations(self) -> Mapping[int, Deformation]:
        """Return the vertices of the pieces that deform, by their ids."""
        return deformations_of(self._bodies, self.pieces)

    def histories(self) -> NDArray[np.int64]:
        """Return (N,) numbers; a piece's past before its number changed has been cut off."""
        histories = self._ids.histories
        return np.array([histories[piece.body_id] for piece in self.pieces], dtype=np.int64)

    def add(self, placement: Placement) -> int:
        """Put a body into the engine; return its instance id. See `add_all`."""
        return self.add_all((placement,))[0]

    def add_all(self, placements: Sequence[Placement]) -> tuple[int, ...]:
        """Put bodies into the engine, all of them or none; return their ids.

        Their parts get the next ones.

        Raises
        ------
        NameTaken, InvalidRequest
            If there is one of that name, or no id is left.
        """
        self._ids.require(sum(1 + len(placement.asset.parts) for placement in placements))
        added: list[int] = []
        try:
            for placement in placements:
                added.append(self._add_body(placement))
            self.joints.arrange(self)
        except BaseException:
            for body_id in reversed(added):
                self._bodies.pop(body_id).remove()
                del self._ids.histories[body_id], self._parts[body_id]
                self._ids.last -= 1
            raise
        for body_id in added:
            self._number_parts(body_id)
        return tuple(added)

    def remove_all(self, numbers: Sequence[int]) -> None:
        """Take bodies out of the engine that hang together, and wake what rests upon them."""
        for number in numbers:
            self._take_out(number).remove()
        self._forget(numbers)

    def remove(self, instance_id: int) -> None:
        """Take a body out of the engine, and wake what rests upon it."""
        if instance_id in self.waiting:
            self._last_poses.note(instance_id, None, self.waiting)
            self.waiting.forget(instance_id)
            self._forget((instance_id,))
        else:
            self.joints.require_nothing_on(self[instance_id], "to be removed")
            self.remove_all((instance_id,))

    def require_free(self, instance_id: int) -> None:
        """Refuse an object that is on a joint or carries one."""
        if instance_id in self.waiting:
            return
        body, what = self[instance_id], "object that comes and goes"
        if body.placement.joint is not None:
            raise InvalidRequest(what, body.placement.name, "one that is not on a joint")
        self.joints.require_nothing_on(body, "that comes and goes")

    def leave(self, instance_id: int) -> None:
        """Take a body out of the engine as `remove` does, but keep its ids for when it enters."""
        gone = self._take_out(instance_id)
        self.waiting.take_back(instance_id, gone)
        gone.remove()
        self._pieces = None
        self.joints.arrange(self)

    def enter(self, instance_id: int, *, seed: int, start_s: float) -> None:
        """Put a body that waits into the engine, at its place of the start and without a past."""
        placement = self.waiting.give(instance_id, seed=seed, start_s=start_s)
        self._bodies[instance_id] = make_body(self._client, placement)
        self._bodies = dict(sorted(self._bodies.items()))
        self.reset_motion_history(instance_id)
        self._pieces = None
        self.joints.arrange(self)

    def rebuild(self, instance_id: int, placement: Placement) -> None:
        """Make of a body what another placement says, as `World.replace_body`."""
        old = self[instance_id]
        if placement.name != old.placement.name:
            self._require_free_name(placement.name)
            self.joints.require_nothing_on(old, "to be renamed")
        if not placement.static and placement.joint is None:
            self.joints.require_nothing_on(old, "that moves freely")
        self._pieces = None
        if repaint(old, placement):
            return
        new = old.rebuilt(placement)
        self.wake_neighbours(old)
        self._bodies[instance_id] = new
        try:
            self.joints.arrange(self)
        except BaseException:
            self._bodies[instance_id] = old
            new.remove()
            raise
        old.remove()

    def replace_room(self, placements: Iterable[Placement], without: Collection[int] = ()) -> None:
        """Exchange all parts of the room, and take out others; parts of a same name keep their id.

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
        self._ids.require(sum(placement.name not in parts for placement in wanted))
        made = make_bodies(self._client, wanted)
        for id_ in leaving:
            self._last_poses.note(id_, self._bodies[id_], self.waiting)
            self._bodies[id_].remove()
        for body in made:
            id_ = parts.get(body.placement.name) or self._ids.take(1)[0]
            self._bodies[id_] = body
            self._parts[id_] = ()  # what makes rooms labels all of a wall alike
            self.reset_motion_history(id_)
            leaving.discard(id_)
        for id_ in leaving:
            del self._bodies[id_], self._ids.histories[id_], self._parts[id_]
        self._pieces = None
        self.joints.arrange(self)
        self._room_parts = frozenset(placement.name for placement in wanted)

    def wake_neighbours(self, body: Body) -> None:
        """Wake what sleeps beside or upon a body that is about to leave its place."""
        touching = body.touching_ids()
        for other in (*self, *self.others()):
            if other is not body and other.bullet_id in touching:
                other.wake()

    def reset_motion_history(self, body_id: int) -> None:
        """Begin a new history: flow does not see where the body was before."""
        self._ids.begin_history(body_id)

    def _add_body(self, placement: Placement, *, waits: bool = False) -> int:
        self._require_free_name(placement.name)
        self._ids.require(1)
        body_id = self._ids.last + 1
        if waits:
            self.waiting.take(body_id, placement)
        else:
            self._bodies[body_id] = make_body(self._client, placement)
        self._ids.take(1)
        self._parts[body_id] = ()
        self.reset_motion_history(body_id)
        return body_id

    def _forget(self, numbers: Sequence[int]) -> None:
        for number in numbers:
            del self._ids.histories[number], self._parts[number]
        self._pieces = None
        self.joints.arrange(self)

    def _take_out(self, body_id: int) -> Body:
        gone = self[body_id]
        self.wake_neighbours(gone)
        self._last_poses.note(body_id, gone, self.waiting)
        return self._bodies.pop(body_id)

    def _number_parts(self, body_id: int) -> None:
        waits = body_id in self.waiting
        placement = self.waiting[body_id] if waits else self._bodies[body_id].placement
        self._parts[body_id] = self._ids.take(len(placement.asset.parts))
        self._pieces = None

    def _require_free_name(self, name: str) -> None:
        if any(body.placement.name == name for body in self) or name in self.waiting.names():
            raise NameTaken("object", name)
