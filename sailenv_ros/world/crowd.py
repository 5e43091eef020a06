"""The world around people as they know it: free places, ways, seats, and each other.

Bodies in, places and ways out. A map of free space is made when a way is wanted and what stands
around has moved by more than a hand's breadth since the last one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.footsteps import Way
from sailenv_ros.space.free_space import FREE, BodySize, FreeSpace
from sailenv_ros.space.grid import map_free_space
from sailenv_ros.space.outlines import Solid, solids_of
from sailenv_ros.types.labels import ROOM_PARTS
from sailenv_ros.world.beds import Lane, lanes_of
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.perches import Perch, perches_of
from sailenv_ros.world.seats import Seat, seats_of
from sailenv_ros.world.ways import Disc, Place, nearest_cell, way_between

__all__ = ["Crowd", "Inhabitant", "body_size", "solids_of_body"]

Doubles = NDArray[np.float64]


class Inhabitant(NamedTuple):
    """A person or an animal as others see it.

    Attributes
    ----------
    x, y : float
        Where it is [m].
    radius_m : float
        That it takes.
    eyes_m : float
        Height of its eyes over the world's origin.
    """

    x: float
    y: float
    radius_m: float
    eyes_m: float


_MOVER_EYES_M = 0.8
"""Height at which one looks at a mover [m]."""

_ROUNDED_M = 0.05
_APART_M = 0.5
"""Distance of places that two can use [m]."""

_NEARER_M = 0.04
"""By which one comes nearer to another whom one would walk into, and not by turning on the spot
beside it [m]."""

_BESIDE_M = 0.02
"""Added to the radius of a body: between the middles of two free cells a way comes so much nearer
to furniture [m]."""


class Crowd:
    """The surroundings of all people of a world.

    Parameters
    ----------
    bodies : callable
        Returns all bodies.
    others : callable
        Returns the discs of movers.
    """

    def __init__(
        self,
        bodies: Callable[[], Iterable[Body]],
        others: Callable[[], Iterable[Disc]],
    ) -> None:
        self._all, self._others = bodies, others
        self._key: bytes = b""
        self._maps: dict[BodySize, FreeSpace] = {}
        self._seats: tuple[Seat, ...] | None = None
        self._lanes: tuple[Lane, ...] | None = None
        self._perches: dict[float, tuple[Perch, ...]] = {}
        self.people: dict[str, Inhabitant] = {}
        self.taken: dict[str, tuple[Place, ...]] = {}

    def _bodies(self) -> list[Body]:
        """Return the bodies that are no people."""
        return [body for body in self._all() if body.placement.asset.rig is None]

    def discs(self, without: str) -> list[Disc]:
        """Return what others take: people but one, and movers."""
        found = [(o.x, o.y, o.radius_m) for name, o in self.people.items() if name != without]
        return [*found, *self._others()]

    def is_free(self, name: str, place: Place) -> bool:
        """Return whether nobody but that person uses a place."""
        return all(
            np.hypot(place[0] - x, place[1] - y) > _APART_M
            for other, places in self.taken.items()
            for x, y in places
            if other != name
        )

    def blocks(self, name: str, radius_m: float, way: Way, number: int) -> bool:
        """Return whether someone stands where a person is after the next steps of its way."""
        here = way.at(number * way.step_s)
        for ahead in (way.steps_of_pace, 2 * way.steps_of_pace):
            there = way.at((number + ahead) * way.step_s)
            for x, y, radius in self.discs(name):
                now = np.hypot(x - here.x, y - here.y)
                then = np.hypot(x - there.x, y - there.y)
                if then < radius + radius_m and then < now - _NEARER_M:
                    return True
        return False

    def face(self, name: str) -> Doubles | None:
        """Return (3,): where one looks who looks at a person, an animal or an object [m]."""
        other = self.people.get(name)
        if other is None:
            return self.middle(name)
        return np.array([other.x, other.y, other.eyes_m])

    def nearest_face(self, name: str, place: Place, most_m: float) -> Doubles | None:
        """Return (3,): the eyes of whom somebody else has nearest, person, animal or mover [m]."""
        found = [other for other_name, other in self.people.items() if other_name != name]
        found += [Inhabitant(x, y, radius, _MOVER_EYES_M) for x, y, radius in self._others()]
        away = [(float(np.hypot(o.x - place[0], o.y - place[1])), n) for n, o in enumerate(found)]
        if not away or min(away)[0] > most_m:
            return None
        nearest = found[min(away)[1]]
        return np.array([nearest.x, nearest.y, nearest.eyes_m])

    def seats(self) -> tuple[Seat, ...]:
        """Return all seats."""
        self._follow()
        if self._seats is None:
            self._seats = tuple(seat for body in self._bodies() for seat in seats_of(body))
        return self._seats

    def lanes(self) -> tuple[Lane, ...]:
        """Return all places to lie."""
        self._follow()
        if self._lanes is None:
            self._lanes = tuple(lane for body in self._bodies() for lane in lanes_of(body))
        return self._lanes

    def perches(self, half_m: float) -> tuple[Perch, ...]:
        """Return all perches for a body of half that length."""
        self._follow()
        if half_m not in self._perches:
            bodies = self._bodies()
            self._perches[half_m] = tuple(p for body in bodies for p in perches_of(body, half_m))
        return self._perches[half_m]

    def body(self, name: str) -> Body | None:
        """Return the body of that name, if there is one."""
        return next((body for body in self._bodies() if body.placement.name == name), None)

    def middle(self, name: str) -> Doubles | None:
        """Return (3,): the middle of an object in the world [m]; None if there is none."""
        body = self.body(name)
        return None if body is None else _place_in(body, 0.5)

    def before(self, name: str, away_m: float) -> tuple[Place, float] | None:
        """Return a place before the front of an object, and the way to it from there [rad]."""
        body = self.body(name)
        if body is None:
            return None
        middle, front = _place_in(body, 0.5), _place_in(body, 1.0)
        out = front[:2] - middle[:2]
        out /= max(float(np.linalg.norm(out)), 1e-6)
        x, y = (front[:2] + away_m * out).tolist()
        return (x, y), float(np.arctan2(-out[1], -out[0]))

    def things(self) -> tuple[str, ...]:
        """Return the names of furniture."""
        return tuple(
            body.placement.name
            for body in self._bodies()
            if body.placement.asset.category not in ROOM_PARTS
            and body.collides
            and float(np.ptp(body.placement.asset.model.bounds()[:, 2])) > 0.3
        )

    def free_space(self, size: BodySize) -> FreeSpace:
        """Return the map for a body, without people."""
        self._follow()
        if size not in self._maps:
            solids = [solid for body in self._bodies() for solid in solids_of_body(body)]
            self._maps[size] = map_free_space(solids, size)
        return self._maps[size]

    def random_place(self, size: BodySize, start: Place, rng: np.random.Generator) -> Place | None:
        """Return a free place that can be reached; None if there is none."""
        space = self.free_space(size)
        cell = nearest_cell(space, start)
        if cell is None:
            return None
        region = space.regions == space.regions[cell]
        rows, columns = np.nonzero(region)
        number = int(rng.integers(len(rows)))
        x, y, _ = space.position_of(int(rows[number]), int(columns[number]))
        return x, y

    def places_beside(
        self, name: str, size: BodySize, place: Place, most_m: float, count: int = 4
    ) -> list[Place]:
        """Return free places that a person can reach near a place, the nearest first [m]."""
        space = self.free_space(size)
        own = self.people.get(name)
        start = nearest_cell(space, place if own is None else (own.x, own.y))
        if start is None:
            return []
        rows, columns = np.nonzero(space.regions == space.regions[start])
        side = space.resolution_m
        found = np.stack(
            [
                space.origin_m[0] + (columns + 0.5) * side,
                space.origin_m[1] + (rows + 0.5) * side,
            ],
            axis=1,
        )
        away = np.linalg.norm(found - place, axis=1)
        chosen: list[Place] = []
        for number in np.argsort(away, kind="stable").tolist():
            if away[number] > most_m or len(chosen) >= count:
                break
            if all(np.hypot(*(found[number] - one)) > 0.3 for one in chosen):
                chosen.append((float(found[number, 0]), float(found[number, 1])))
        return chosen

    def bodies(self, without: str = "") -> list[Body]:
        """Return what is in the way of things and is no person, but one body."""
        return [b for b in self._bodies() if b.collides and b.placement.name != without]

    def is_clear(self, size: BodySize, places: Doubles) -> bool:
        """Return whether a body has room at (N, 2) places [m]."""
        space = self.free_space(size)
        cells = [space.cell_of((x, y)) for x, y in places.tolist()]
        return all(cell is not None and space.cells[cell] == FREE for cell in cells)

    def way(
        self, size: BodySize, start: Place, goal: Place, around: Iterable[Disc] = ()
    ) -> list[Place] | None:
        """Return the corners of a way between two places, or None.

        See `ways.way_between`.
        """
        grown = [(x, y, radius + size.radius_m) for x, y, radius in around]
        return way_between(self.free_space(size), start, goal, grown)

    # -- inside ----------------------------------------------------------------------------

    def _follow(self) -> None:
        """Forget what is known if things have moved."""
        places = []
        for body in self._bodies():
            matrix = body.world_from_body()
            places.append(np.round(matrix[:3] / [*([0.2] * 3), _ROUNDED_M]).astype(np.int64))
        key = np.array(places).tobytes()
        if key != self._key:
            self._key, self._maps, self._perches = key, {}, {}
            self._seats = self._lanes = None


def body_size(height_m: float, radius: float, floor_m: float) -> BodySize:
    """Return the cylinder that stands for a body on a floor: its radius is over its height [m]."""
    return BodySize(
        height_m=max(round(1.06 * height_m, 1), 0.4),
        radius_m=round(radius * height_m + _BESIDE_M, 2),
        floor_m=round(floor_m, 3),
        step_m=0.05,
    )


def _place_in(body: Body, share: float) -> Doubles:
    """Return a place of a body's box in the world: from its back, 0, to its front, 1 [m]."""
    low, high = body.placement.asset.model.bounds() * np.asarray(body.placement.scale)
    own = 0.5 * (low + high)
    own[0] = low[0] + share * (high[0] - low[0])
    matrix = body.world_from_body()
    place: Doubles = matrix[:3, :3] @ own + matrix[:3, 3]
    return place


def solids_of_body(body: Body) -> Iterator[Solid]:
    """Yield what physics knows of a body, as convex solids in the world."""
    placement = body.placement
    return solids_of(placement.asset.collision, placement.scale, body.world_from_body())
