"""A person: a body that moves its limbs by itself, and that nothing pushes.

Its pose, and where its feet stand, follow from the way that it goes; its posture from that and
time. In the engine it is capsules along its bones, which push others aside.
"""

from __future__ import annotations

import math
import zlib
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S, RunningBehaviour
from sailenv_ros.behaviours.person import Activity
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.deformation_kernels import skin
from sailenv_ros.native.library import thread_count
from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.footsteps import (
    FootPrint,
    Moment,
    Stride,
    Way,
    standing_feet,
    way_along,
    way_to_turn,
)
from sailenv_ros.postures.sitting import SIT_S, SeatPlace, seat_distance_m, sitting_posture
from sailenv_ros.postures.skeleton import Posture, joint_frames, skin_matrices
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rig import Rig
from sailenv_ros.types.skeleton import Skeleton
from sailenv_ros.world.bodies import Body, FrustumPlanes, Vector3
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient
from sailenv_ros.world.crowd import Crowd, body_size
from sailenv_ros.world.limbs import Limbs
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.seats import Seat

__all__ = ["PersonBody"]

Doubles = NDArray[np.float64]
Place = tuple[float, float]

_LIMB_STEPS = 8
"""Steps of physics after which the capsules of limbs follow."""

_BLOCKED_S = 1.2
"""Time for which one waits for another who is in the way [s]."""

_LEAST_WAY_M = 0.12
_STAND_OFF_M = 0.42
"""Distance from which one looks at a thing [m]."""

_FEET_BEFORE_M = 0.02


class PersonBody(Body):
    """A body with a skeleton; parameters as `Body`.

    Attributes
    ----------
    crowd : Crowd or None
        What it knows of the world; without it, it stands.
    problem : str
        Why it has not arrived where it was last sent; empty if it has.
    """

    def __init__(self, client: BulletClient, placement: Placement) -> None:
        assert placement.asset.rig is not None
        sx, sy, sz = placement.scale
        if not sx == sy == sz:
            raise InvalidRequest(
                f"scale of {placement.name!r}", placement.scale, "the same along all axes"
            )
        self._rig: Rig = placement.asset.rig
        self._figure = figure_of(self._rig)
        self._scale = float(sx)
        self.crowd: Crowd | None = None
        self.problem = ""
        self._time_s = 0.0
        self._steps = 0
        self._stand_at(placement.pose)
        super().__init__(client, replace(placement, static=False))
        self._limbs = Limbs(client, self._rig) if self._scale == 1.0 else None
        self._matrix_now = self._matrix_before = self._matrix_of_moment()
        self._posed: tuple[object, Deformation] | None = None
        self._place_limbs()

    # -- what Body asks for -----------------------------------------------------------------

    @property
    def acts(self) -> bool:
        """True: it breathes and walks by itself."""
        return True

    @property
    def collides(self) -> bool:
        """True: its limbs do."""
        return True

    @property
    def limb_ids(self) -> list[int]:
        """The engine's numbers of its capsules."""
        return [] if self._limbs is None else self._limbs.ids

    def world_from_body(self) -> Doubles:
        """Return the (4, 4) pose now; not to be written to."""
        return self._matrix_now

    def pose(self) -> Pose:
        """Return the pose of the body frame now."""
        return Pose.from_matrix(self._matrix_now)

    def put(self, pose: Pose) -> None:
        """Set the pose; it stands there."""
        self.arranged = False
        self._leave_seat()
        self._stand_at(pose)
        self._matrix_now = self._matrix_before = self._matrix_of_moment()
        self._place_limbs()

    def wake(self) -> None:
        """Nothing: it is never asleep."""

    def velocity(self) -> tuple[Doubles, Doubles]:
        """Return the velocity of the body frame's origin [m/s] and the angular one [rad/s]."""
        linear = (self._matrix_now[:3, 3] - self._matrix_before[:3, 3]) / STEP_S
        before = np.arctan2(self._matrix_before[1, 0], self._matrix_before[0, 0])
        now = np.arctan2(self._matrix_now[1, 0], self._matrix_now[0, 0])
        turn = (now - before + np.pi) % (2.0 * np.pi) - np.pi
        return linear, np.array([0.0, 0.0, turn / STEP_S])

    def origin_velocity(self, world_from_body: Doubles) -> tuple[Vector3, Vector3]:
        """Return the same, whatever the pose."""
        (vx, vy, vz), (wx, wy, wz) = (part.tolist() for part in self.velocity())
        return (vx, vy, vz), (wx, wy, wz)

    def orientation_of_matrix(self) -> tuple[float, float, float, float]:
        """Return the quaternion x, y, z, w of the pose."""
        return self.pose().orientation_xyzw

    def rebuilt(self, placement: Placement) -> Body:
        """Make the person that another placement says, in the same place."""
        new = PersonBody(self._client, replace(placement, pose=self.pose()))
        new._behaviours, new.crowd = self._behaviours, self.crowd
        new.entry_pose = self.entry_pose
        new.behaviours_unchanged = self.behaviours_unchanged
        return new

    def push(self, wrench: RunningBehaviour) -> None:
        """Refuse: nothing pushes a person.

        Raises
        ------
        InvalidRequest
        """
        name = self.placement.name
        raise InvalidRequest("object", name, "one that physics moves: people move by themselves")

    def behave(
        self, running: RunningBehaviour, time_s: float, frustum_planes: FrustumPlanes
    ) -> None:
        """Ask a behaviour, which tells the person what to do."""
        state = replace(self._state(running, frustum_planes), person=self)
        running.act(time_s, state)

    def remove(self) -> None:
        """Take the body out of the engine."""
        self._leave_seat()
        if self.crowd is not None:
            self.crowd.people.pop(self.placement.name, None)
        if self._limbs is not None:
            self._limbs.remove()
        super().remove()

    def _build(self) -> int:
        # Limbs stand for it; this alone is what its number stands for.
        body = self._client.createMultiBody(
            baseMass=0.0,
            baseCollisionShapeIndex=-1,
            basePosition=self.placement.pose.position_m,
            useMaximalCoordinates=1,
        )
        return int(body)

    def touching_ids(self) -> frozenset[int]:
        """Return the engine's numbers of what touches its limbs."""
        found: set[int] = set()
        for limb in self.limb_ids:
            low, high = self._client.getAABB(limb, LINK_OF_BASE)
            near = self._client.getOverlappingObjects(low, high)
            found.update(body for body, _ in near or ())
        return frozenset(found)

    # -- time ------------------------------------------------------------------------------

    def advance(self, time_s: float) -> None:
        """Go on for the step that begins at a simulated time [s]."""
        self._time_s = time_s + STEP_S
        self._steps += 1
        self._matrix_before = self._matrix_now
        if self._way is not None:
            self._walk_on()
        elif self._seat is not None:
            self._sit_on()
        if self.crowd is not None:
            x, y = float(self._matrix_now[0, 3]), float(self._matrix_now[1, 3])
            self.crowd.people[self.placement.name] = (x, y, self._radius_m)
        if self._steps % _LIMB_STEPS == 0:
            self._place_limbs()

    @property
    def posture(self) -> Posture:
        """Where its root and joints are now, in the body frame before the scale."""
        moment = self._scaled(self._moment())
        look = self._look_deg()
        seed = zlib.crc32(self.placement.name.encode()) % 97
        if self._seat is not None and self._way is None:
            share = min(self._sit_s / SIT_S, 1.0)
            return sitting_posture(
                self._rig, moment, self._seat_place, share, self._time_s, seed=seed, look_deg=look
            )
        return walking_posture(self._rig, moment, self._time_s, seed=seed, look_deg=look)

    def deformation(self) -> Deformation:
        """Return where its skin is now; the same object until it moves."""
        posture = self.posture
        matrices = np.ascontiguousarray(skin_matrices(self._rig, posture))
        key = matrices.tobytes()
        if self._posed is None or self._posed[0] != key:
            model, rig = self.placement.asset.model, self._rig

            def made() -> list[tuple[NDArray[np.float32], NDArray[np.float32]]]:
                return [
                    skin(
                        part.mesh.positions,
                        part.mesh.normals,
                        bones,
                        weights,
                        matrices,
                        threads=thread_count(),
                    )
                    for part, bones, weights in zip(
                        model.parts, rig.bones, rig.weights, strict=True
                    )
                ]

            self._posed = key, Deformation(model, made)
        return self._posed[1]

    def skeleton(self) -> Skeleton:
        """Return where its joints and keypoints are now."""
        rig = self._rig
        turns, places = joint_frames(rig, self.posture)
        points = np.array([
            places[point.joint]
            + turns[point.joint] @ (np.asarray(point.position_m) - rig.heads[point.joint])
            for point in rig.points
        ]).reshape(-1, 3)  # fmt: skip
        matrix = self._matrix_now
        return Skeleton(
            joint_names=rig.names,
            parents=rig.parents,
            joints=self._scale * places @ matrix[:3, :3].T + matrix[:3, 3],
            point_names=tuple(point.name for point in rig.points),
            points=self._scale * points @ matrix[:3, :3].T + matrix[:3, 3],
        )

    # -- what behaviours tell it (see behaviours.person.Person) --------------------------------

    @property
    def activity(self) -> Activity:
        """What it does now."""
        if self._way is not None:
            return "walking"
        if self._seat is None:
            return "standing"
        if self._rises:
            return "getting up"
        return "seated" if self._sit_s >= SIT_S else "sitting down"

    def random_place(self, rng: np.random.Generator) -> Place | None:
        """Return a free place that it can reach [m]; None if there is none."""
        if self.crowd is None:
            return None
        return self.crowd.random_place(self._size, self._place, rng)

    def walk_to(self, place: Place) -> bool:
        """Begin to walk to a place [m]; False, and nothing begins, if no way leads there."""
        return self._go(place, None)

    def walk_near(self, name: str) -> bool:
        """Begin to walk to where it stands before an object and faces it; False if it cannot."""
        if self.crowd is None:
            return False
        body = self.crowd.body(name)
        if body is None:
            return False
        matrix = body.world_from_body()
        low, high = body.placement.asset.model.bounds() * np.asarray(body.placement.scale)
        middle = matrix[:3, :3] @ (0.5 * (low + high)) + matrix[:3, 3]
        front = matrix[:3, :3] @ np.array([high[0], 0.5 * (low[1] + high[1]), 0.0]) + matrix[:3, 3]
        away = front[:2] - middle[:2]
        away /= max(float(np.linalg.norm(away)), 1e-6)
        goal = front[:2] + (_STAND_OFF_M + self._radius_m) * away
        yaw = float(np.arctan2(-away[1], -away[0]))
        return self._go((float(goal[0]), float(goal[1])), yaw)

    def sit_on(self, name: str) -> bool:
        """Begin to walk to a seat and sit down; False if it cannot."""
        if self.crowd is None or self._seat is not None or self._way is not None:
            return False
        for seat in self._free_seats():
            if seat.name != name:
                continue
            floor = float(self._matrix_now[2, 3])
            height = seat.height_m - floor
            back = seat_distance_m(self._rig, height / self._scale) * self._scale
            if height > 0.95 * self._figure.leg_m * self._scale:
                continue
            ahead = max(back - min(seat.depth_m, 0.62 * back + 0.08), _FEET_BEFORE_M)
            c, s = float(np.cos(seat.yaw)), float(np.sin(seat.yaw))
            feet = (seat.x + ahead * c, seat.y + ahead * s)
            if not self._go(feet, seat.yaw):
                continue
            self._seat, self._sit_s, self._rises = seat, 0.0, False
            self._seat_place = SeatPlace(
                back_m=back / self._scale, height_m=height / self._scale
            )
            self.crowd.taken[self.placement.name] = (seat.x, seat.y)
            self._pass_through_seat(passes=True)
            return True
        return False

    def get_up(self) -> None:
        """Begin to get up, if it sits."""
        if self._seat is not None and self._way is None:
            self._rises = True

    def seats(self) -> tuple[str, ...]:
        """Return the names of seats that nobody has taken."""
        return tuple(dict.fromkeys(seat.name for seat in self._free_seats()))

    def things(self) -> tuple[str, ...]:
        """Return the names of furniture that one may look at."""
        return () if self.crowd is None else self.crowd.things()

    def look_at(self, name: str) -> None:
        """Look at an object from now on; the empty name looks ahead."""
        self._looks_at = name

    # -- inside ----------------------------------------------------------------------------

    @property
    def _radius_m(self) -> float:
        return self._size.radius_m

    @property
    def _size(self) -> BodySize:
        return body_size(self._figure.height_m * 1.12 * self._scale, self._floor_m)

    @property
    def _place(self) -> Place:
        return float(self._matrix_now[0, 3]), float(self._matrix_now[1, 3])

    def _stand_at(self, pose: Pose) -> None:
        matrix = pose.matrix()
        self._floor_m = float(matrix[2, 3])
        yaw = float(np.arctan2(matrix[1, 0], matrix[0, 0]))
        width = self._figure.stride.width_m * self._scale
        self._feet = standing_feet(float(matrix[0, 3]), float(matrix[1, 3]), yaw, width)
        self._way: Way | None = None
        self._way_s = 0.0
        self._waited_s = 0.0
        self._goal: tuple[Place, float | None] | None = None
        self._seat: Seat | None = None
        self._seat_place = SeatPlace(back_m=0.0, height_m=0.0)
        self._sit_s = 0.0
        self._rises = False
        self._looks_at = ""

    def _moment(self) -> Moment:
        if self._way is not None:
            return self._way.at(self._way_s)
        return Way(start=self._feet, prints=(), step_s=1.0).at(0.0)

    def _scaled(self, moment: Moment) -> Moment:
        """Return a moment in the measures of the skeleton, which is not scaled."""
        if self._scale == 1.0:
            return moment
        k = 1.0 / self._scale

        def print_of(place: FootPrint) -> FootPrint:
            return FootPrint(place.x * k, place.y * k, place.yaw)

        return replace(
            moment,
            feet=(print_of(moment.feet[0]), print_of(moment.feet[1])),
            goal=None if moment.goal is None else print_of(moment.goal),
            x=moment.x * k,
            y=moment.y * k,
            ahead_m=moment.ahead_m * k,
            before_m=moment.before_m * k,
        )

    def _matrix_of_moment(self) -> Doubles:
        moment = self._moment()
        c, s = math.cos(moment.yaw), math.sin(moment.yaw)
        return np.array([
            [c, -s, 0.0, moment.x],
            [s, c, 0.0, moment.y],
            [0.0, 0.0, 1.0, self._floor_m],
            [0.0, 0.0, 0.0, 1.0],
        ])  # fmt: skip

    def _stride(self) -> Stride:
        stride = self._figure.stride
        return replace(
            stride,
            length_m=stride.length_m * self._scale,
            width_m=stride.width_m * self._scale,
        )

    def _go(self, place: Place, yaw: float | None) -> bool:
        if self.crowd is None or self._seat is not None:
            return False
        corners = self.crowd.way(self._size, self._place, place)
        self._goal = (place, yaw)
        return self._follow(corners, yaw)

    def _follow(self, corners: list[Place] | None, yaw: float | None) -> bool:
        """Begin to go along corners; turn to them first, and at the end."""
        if corners is None:
            self.problem = "no way leads there"
            return False
        self.problem = ""
        stride = self._stride()
        way = Way(start=self._feet, prints=(), step_s=stride.step_s)
        line = np.array([self._place, *corners[1:]])
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        if length > _LEAST_WAY_M:
            first = line[1] - line[0]
            heading = float(np.arctan2(first[1], first[0]))
            way = self._turned(way, heading)
            way = way.then(way_along(way.feet_after(len(way.prints)), line, stride))
        if yaw is not None:
            way = self._turned(way, yaw)
        if not way.prints:
            return True
        self._way, self._way_s, self._waited_s = way, 0.0, 0.0
        self._looks_at = ""
        return True

    def _turned(self, way: Way, heading: float) -> Way:
        feet = way.feet_after(len(way.prints))
        now = Way(start=feet, prints=(), step_s=1.0).at(0.0).yaw
        if abs((heading - now + np.pi) % (2.0 * np.pi) - np.pi) < 0.35 and way.prints == ():
            return way
        if abs((heading - now + np.pi) % (2.0 * np.pi) - np.pi) < 0.02:
            return way
        return way.then(way_to_turn(feet, heading, self._stride()))

    def _walk_on(self) -> None:
        way = self._way
        assert way is not None
        number, later = (int(t / way.step_s + 1e-9) for t in (self._way_s, self._way_s + STEP_S))
        if later > number or self._way_s == 0.0:
            if self._is_blocked(way, later):
                self._wait(way, later)
                return
            self._waited_s = 0.0
        self._way_s += STEP_S
        if self._way_s >= way.duration_s:
            self._feet = way.feet_after(len(way.prints))
            self._way = None
        self._matrix_now = self._matrix_of_moment()

    def _is_blocked(self, way: Way, number: int) -> bool:
        if self.crowd is None:
            return False
        here = way.at(number * way.step_s)
        for ahead in (1, 2):
            there = way.at((number + ahead) * way.step_s)
            for x, y, radius in self.crowd.discs(self.placement.name):
                near = radius + self._radius_m
                now = np.hypot(x - here.x, y - here.y)
                then = np.hypot(x - there.x, y - there.y)
                if then < near and then < now:
                    return True
        return False

    def _wait(self, way: Way, number: int) -> None:
        """Stand where a step has ended; go round who stands in the way, or give up."""
        self._waited_s += STEP_S
        if self._waited_s < _BLOCKED_S:
            return
        assert self.crowd is not None
        self._feet = way.feet_after(number)
        self._way, self._waited_s = None, 0.0
        discs = self.crowd.discs(self.placement.name)
        corners, goal = None, self._goal
        seat = self._seat
        if goal is not None:
            corners = self.crowd.way(self._size, self._place, goal[0], discs)
        if corners is not None and goal is not None and self._follow(corners, goal[1]):
            return
        self.problem = "someone stands in the way"
        if seat is not None:
            self._leave_seat()
        # Put the feet side by side where it stands.
        yaw = self._moment().yaw
        way = way_to_turn(self._feet, yaw, self._stride())
        self._way, self._way_s, self._goal = way, 0.0, None

    def _sit_on(self) -> None:
        if not self._rises:
            self._sit_s = min(self._sit_s + STEP_S, SIT_S)
            return
        self._sit_s -= STEP_S
        if self._sit_s <= 0.0:
            self._leave_seat()

    def _leave_seat(self) -> None:
        if self._seat is not None:
            self._pass_through_seat(passes=False)
        self._seat, self._sit_s, self._rises = None, 0.0, False
        if self.crowd is not None:
            self.crowd.taken.pop(self.placement.name, None)

    def _pass_through_seat(self, *, passes: bool) -> None:
        if self.crowd is None or self._seat is None or self._limbs is None:
            return
        body = self.crowd.body(self._seat.name)
        if body is not None:
            self._limbs.pass_through(body.bullet_id, passes=passes)

    def _free_seats(self) -> list[Seat]:
        if self.crowd is None:
            return []
        taken = [
            place for name, place in self.crowd.taken.items() if name != self.placement.name
        ]
        return [
            seat
            for seat in self.crowd.seats()
            if all(np.hypot(seat.x - x, seat.y - y) > 0.5 for x, y in taken)
        ]

    def _look_deg(self) -> tuple[float, float]:
        if not self._looks_at or self.crowd is None:
            return 0.0, 0.0
        body = self.crowd.body(self._looks_at)
        if body is None:
            return 0.0, 0.0
        low, high = body.placement.asset.model.bounds() * np.asarray(body.placement.scale)
        matrix = body.world_from_body()
        target = matrix[:3, :3] @ (0.5 * (low + high)) + matrix[:3, 3]
        own = self._matrix_now[:3, :3].T @ (target - self._matrix_now[:3, 3])
        away = float(np.hypot(own[0], own[1]))
        down = self._figure.height_m * self._scale - float(own[2])
        yaw = float(np.degrees(np.arctan2(own[1], own[0])))
        return yaw, float(np.degrees(np.arctan2(down, max(away, 0.2))))

    def _place_limbs(self) -> None:
        if self._limbs is not None:
            _, places = joint_frames(self._rig, self.posture)
            self._limbs.place(self._matrix_now, places)

