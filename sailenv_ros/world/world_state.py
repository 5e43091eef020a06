"""The live state of a world, as it is read; what changes it is in `world`."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

import numpy as np

from sailenv_ros.scene.spec import RoomSpec, SceneSpec
from sailenv_ros.types.contacts import Contact
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.objects import ObjectState
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot
from sailenv_ros.world.bodies import Body, FrustumPlanes, Placement
from sailenv_ros.world.body_table import BodyTable
from sailenv_ros.world.bullet import LINK_OF_BASE, STEPS_PER_SECOND, BulletClient, sim_time_ns
from sailenv_ros.world.contact_log import ContactLog
from sailenv_ros.world.contents_maker import ContentsMaker
from sailenv_ros.world.crowd import Crowd
from sailenv_ros.world.engine_settings import configure
from sailenv_ros.world.first_states import FirstStates
from sailenv_ros.world.inactive_objects import InactiveObjects
from sailenv_ros.world.labelled_pieces import velocities_of
from sailenv_ros.world.look_at_solver import LookAtSolver
from sailenv_ros.world.motion_log import Motion, MotionLog
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.mover_table import MoverTable
from sailenv_ros.world.object_state import object_state
from sailenv_ros.world.placing_log import PlacingLog
from sailenv_ros.world.resting import begin_at_rest
from sailenv_ros.world.robot_placements import RobotPlacement
from sailenv_ros.world.robot_table import RobotTable
from sailenv_ros.world.step_actions import StepActions

__all__ = ["WorldState"]


class WorldState:
    """The live state of one scene.

    Parameters
    ----------
    scene : str
        Its name.
    epoch : int
        Number of this life of a scene; goes into every snapshot.
    next_revision : callable or None
        Gives a larger number at each call; called at each change of the contents. None counts
        from 1.
    placements : iterable of Placement
        Get instance ids 1, 2, 3 … in this order.
    movers : sequence of Mover
        At least one.
    described : SceneSpec or None
        What a scene file says of it all; None where there is none.
    settled : bool
        False leaves everything exactly where it is placed; see `resting.begin_at_rest`.
    waiting : collection of str
        Names of the placements that are nowhere until they `enter`.
    robots : sequence of RobotPlacement
        Whose links are among the placements.

    Attributes
    ----------
    described : SceneSpec or None
    robots : RobotTable
    frustum_planes : callable
        ``frustum_planes(agent, distance_m)`` returns the (N, 4) planes of an agent's view frustum;
        none unless the owner of the agents has set it.
    """

    def __init__(
        self,
        *,
        scene: str,
        epoch: int = 1,
        next_revision: Callable[[], int] | None = None,
        placements: Iterable[Placement],
        movers: Sequence[Mover],
        categories: CategoryTable,
        lights: Sequence[Light] = (),
        environment: Environment | None = None,
        gravity: tuple[float, float, float] = (0.0, 0.0, -9.81),
        described: SceneSpec | None = None,
        settled: bool = True,
        waiting: Collection[str] = (),
        robots: Sequence[RobotPlacement] = (),
    ) -> None:
        self.scene = scene
        self.epoch = epoch
        self.categories = categories
        self.described = described
        self._first_room = described.room if described is not None else None
        self._client = BulletClient()
        self._stands = MoverTable(self._client, movers)
        self._contact_log = ContactLog(self._client, self._stands.gain)
        self._motion_log, self._placing_log = MotionLog(), PlacingLog()
        self._step = 0
        self._snapshot: WorldSnapshot | None = None
        self._states: InstanceStates | None = None
        self._changed_step = 0
        self.frustum_planes: FrustumPlanes = lambda agent, distance_m: np.zeros((0, 4))
        try:
            configure(self._client)
            self._client.gravity = gravity
            self._bodies = BodyTable(self._client, placements, waiting)
            self._bodies.others = lambda: self._stands.bodies
            self.robots = RobotTable(self._client, self._bodies, robots, self._stands)
            begin_at_rest(self._client, self.bodies, settled=settled)
            self._stands.enter()
            self._crowd = Crowd(lambda: self._bodies, lambda: self._stands.places(self.sim_time_ns))
            self._first = FirstStates(self._bodies)
        except BaseException:
            self.close()
            raise
        self._shown = ContentsMaker(
            scene=scene,
            epoch=epoch,
            categories=categories,
            lights=tuple(lights),
            environment=environment or Environment(),
            bodies=self._bodies,
            described=lambda: self.described,
            next_revision=next_revision or itertools.count(1).__next__,
        )

    # -- time ------------------------------------------------------------------------------

    @property
    def step_count(self) -> int:
        """Physics steps so far."""
        return self._step

    @property
    def sim_time_ns(self) -> int:
        """Simulated time so far [ns]."""
        return sim_time_ns(self._step)

    def step(self, count: int = 1) -> None:
        """Advance by so many steps of 1/240 s."""
        pushed = (*self._bodies, *self._stands.bodies)
        actions = StepActions(self._client, pushed, self.frustum_planes, self._crowd)
        for left in range(count, 0, -1):
            if left == 1:
                self._motion_log.before_step(self._step, self._bodies.items())
            actions.act(self._step / STEPS_PER_SECOND)
            self._stands.before_step(self.sim_time_ns)
            self.robots.before_step(self._step)
            self._bodies.joints.before_step()
            self._client.stepSimulation()
            self._stands.after_step(self.sim_time_ns)
            self._step += 1
            if self._bodies.joints.after_step():
                self._changed_step = self._step
            self._contact_log.after_step(self._step)
        if count:
            self._snapshot = self._states = None

    # -- what is read ----------------------------------------------------------------------

    @property
    def contents(self) -> SceneContents:
        """Contents of the world at present, apart from poses."""
        return self._shown.current

    @property
    def changed_ns(self) -> int:
        """When what stands still was last moved, painted, put there or taken away [ns]."""
        return sim_time_ns(self._changed_step)

    @property
    def numbered_bodies(self) -> Iterable[tuple[int, Body]]:
        """All bodies with their instance ids."""
        return self._bodies.items()

    @property
    def client(self) -> BulletClient:
        """The physics engine; for what lies in this package."""
        return self._client

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies, in the order of their ids."""
        return tuple(self._bodies)

    @property
    def bodies_by_id(self) -> Mapping[int, Body]:
        """All bodies by their instance ids, in the order of these."""
        return dict(self._bodies.items())

    @property
    def movers(self) -> Mapping[str, Mover]:
        """The movers by name, in the scene's order; read-only."""
        return self._stands.by_name

    @property
    def missing_parts(self) -> frozenset[str]:
        """Names of the parts of the room that were there at the start and are no more."""
        return self._bodies.missing_room_parts

    @property
    def room_changed(self) -> bool:
        """True if what stands at the walls would stand elsewhere than in the room of the start."""
        now = None if self.described is None else self.described.room
        return _walls_of(now) != _walls_of(self._first_room)

    @property
    def first_room(self) -> RoomSpec | None:
        """The room of the start, as its file describes it."""
        return self._first_room

    @property
    def first_bodies(self) -> Mapping[str, Body]:
        """The bodies of the start that are still there, by the names that they had then."""
        return self._bodies.firsts

    @property
    def moving_ids(self) -> frozenset[int]:
        """Ids of the instances that a behaviour moves."""
        return frozenset(piece.id for piece in self._bodies.pieces if piece.body.behaviours)

    def snapshot(self) -> WorldSnapshot:
        """Copy the poses; the same object until something changes."""
        if self._snapshot is None:
            poses = self._bodies.world_from_body()
            self._shown.light_lamps(poses)
            self._snapshot = WorldSnapshot(
                sim_time_ns=self.sim_time_ns,
                step=self._step,
                contents=self._shown.current,
                world_from_body=poses,
                histories=self._bodies.histories(),
                velocities=velocities_of(self._bodies.pieces, poses),
                settling=self._placing_log.settling(self._bodies.pieces, self._step),
                deformations=self._bodies.deformations(),
            )
        return self._snapshot

    def states(self) -> InstanceStates:
        """Return poses and velocities of all instances; the same object until something changes."""
        snapshot = self.snapshot()
        if self._states is None:
            self._states = self._bodies.states(snapshot)
        return self._states

    def mover(self, name: str) -> Mover:
        """Find a mover; the empty name means the scene's first. Raises UnknownName."""
        return self._stands[name]

    def body(self, instance_id: int) -> Body:
        """Find the body of an object.

        Raises
        ------
        InvalidRequest
            If no object has that id now, also if a part of one has it.
        """
        return self._bodies[instance_id]

    def find(self, obj: int | str) -> int:
        """Return the instance id of an object, or a part of one, that is named by its id or name.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such object now.
        """
        return self._bodies.find(obj)

    def pushed(self, obj: int | str) -> Body:
        """Find what a wrench acts upon: an object by its id or name, else a mover by its name.

        Raises
        ------
        UnknownName, InvalidRequest, InvalidState
            If there is neither, or the mover is not a body.
        """
        if isinstance(obj, str) and obj in self._stands.by_name:
            objects = [body.placement.name for body in self._bodies]
            if obj not in (*objects, *self._bodies.waiting.names()):
                return self._stands[obj].require_body()
        return self.body(self.find(obj))

    def gaze(self, look_at: LookAt) -> LookAtSolver:
        """Return a look-at constraint in this world.

        Raises
        ------
        UnknownName
            If no object of that name is there or waits.
        """
        return LookAtSolver(self._bodies, look_at)

    def object_state(self, instance_id: int) -> ObjectState:
        """Return what and where an object, or a part of one, is now.

        Raises
        ------
        InvalidRequest
            If no instance has that id now.
        """
        piece = self._bodies.piece(instance_id)
        drawn = self._shown.drawn(piece)
        model = drawn.model if piece.part else piece.body.placement.asset.model
        return object_state(piece.body, drawn.instance, self.sim_time_ns, model)

    def contacts(self, seconds: float = 0.0) -> tuple[Contact, ...]:
        """Return what touched what in the last step, and in so much simulated time before [s].

        The first question hears of the last step alone: each step is kept only after it.
        """
        ids = {(body.bullet_id, body.link): id_ for id_, body in self._bodies.items()}
        ids |= {
            (limb, LINK_OF_BASE): id_
            for id_, body in self._bodies.items()
            for limb in body.limb_ids
        }
        count = max(1, round(seconds * STEPS_PER_SECOND))
        return self._contact_log.contacts(self._step, count, ids, self._stands.pieces)

    def accelerations(self) -> dict[int, Motion]:
        """Return how bodies accelerated in the last step, by instance id; see `MotionLog`."""
        return self._motion_log.accelerations(self._step, self._bodies.items())

    @property
    def waiting(self) -> InactiveObjects:
        """The objects that are nowhere now; read-only."""
        return self._bodies.waiting

    @property
    def gravity(self) -> tuple[float, float, float]:
        """Acceleration of bodies with gravity, world frame [m/s²]."""
        return self._client.gravity

    def close(self) -> None:
        """Free the engine; a second call does nothing."""
        self._client.close()

    def _changed(self) -> None:
        self._shown.renew()
        self._snapshot = self._states = None


def _walls_of(room: RoomSpec | None) -> tuple[object, ...] | None:
    """Return what decides where things at a room's walls stand."""
    return None if room is None else (room.size, room.skirting and room.skirting.depth)
