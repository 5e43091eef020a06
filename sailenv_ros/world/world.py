"""The world: rigid bodies, movers and lights of one scene, stepped by PyBullet.

A `SceneSpec` comes in through `world.build`, `WorldSnapshot`s go out. Time is a count of steps;
there is no wall clock and no global random state here, so the same scene, seed and calls give
the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.baked_light import BakedLight
from sailenv_ros.contacts import Contact
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.geometry import Pose
from sailenv_ros.instance_states import InstanceStates
from sailenv_ros.joints import JointState
from sailenv_ros.labels import PART_MARK, CategoryTable, Instance, Keypoint
from sailenv_ros.lights import Environment, Light
from sailenv_ros.look_at import LookAt
from sailenv_ros.objects import ObjectState
from sailenv_ros.rigid_body import RigidBody
from sailenv_ros.scene.spec import RoomSpec, SceneSpec
from sailenv_ros.snapshot import DrawnInstance, SceneContents, WorldSnapshot
from sailenv_ros.world.bodies import Body, FrustumPlanes, Placement
from sailenv_ros.world.body_table import BodyTable, LabelledPiece
from sailenv_ros.world.bullet import STEPS_PER_SECOND, BulletClient, sim_time_ns
from sailenv_ros.world.contact_log import ContactLog
from sailenv_ros.world.gaze import Gaze
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.lit_lamps import lit_by
from sailenv_ros.world.mover import Mover, MoverCommand
from sailenv_ros.world.moving_stands import MovingStands
from sailenv_ros.world.resting import begin_at_rest
from sailenv_ros.world.step_actions import StepActions
from sailenv_ros.world.waiting_room import WaitingRoom

__all__ = ["World"]

SOLVER_RESIDUAL = 1e-5
"""Sum of the squared changes of velocities at which the engine's solver ends [m²/s²]; with ten
times as much, cutlery on a plate never comes to rest."""

WARM_STARTING = 0.85
"""Share of a contact's last impulse that the solver begins with, Bullet's own default; with
PyBullet's 0.1 a book that lies on a bed trembles for ever."""


class World:
    """The live state of one scene.

    Parameters
    ----------
    scene : str
        Its name.
    epoch : int
        Number of this life of a scene; goes into every snapshot.
    next_revision : callable
        Gives a larger number at each call; called at each change of the contents.
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

    Attributes
    ----------
    described : SceneSpec or None
    frustum_planes : callable
        ``frustum_planes(agent, distance_m)`` returns the (N, 4) planes of an agent's view frustum;
        none unless whoever knows the agents has set it.
    """

    def __init__(
        self,
        *,
        scene: str,
        epoch: int,
        next_revision: Callable[[], int],
        placements: Iterable[Placement],
        movers: Sequence[Mover],
        categories: CategoryTable,
        lights: Sequence[Light] = (),
        environment: Environment | None = None,
        gravity: tuple[float, float, float] = (0.0, 0.0, -9.81),
        described: SceneSpec | None = None,
        settled: bool = True,
        waiting: Collection[str] = (),
    ) -> None:
        self.scene = scene
        self.epoch = epoch
        self.categories = categories
        self.described = described
        self._first_room = described.room if described is not None else None
        self._next_revision = next_revision
        self._lights = tuple(lights)
        self._environment = environment or Environment()
        self._baked: BakedLight | None = None
        self._client = BulletClient()
        self._stands = MovingStands(self._client, movers)
        self._contact_log = ContactLog(self._client, self._stands.gain)
        self._step = 0
        self._snapshot: WorldSnapshot | None = None
        self._states: InstanceStates | None = None
        self._changed_step = 0
        self._lit_by: Mapping[int, tuple[str, ...]] = {}
        self.frustum_planes: FrustumPlanes = lambda agent, distance_m: np.zeros((0, 4))
        try:
            self._configure()
            self._client.gravity = gravity
            self._bodies = BodyTable(self._client, placements, waiting)
            self._bodies.others = lambda: self._stands.bodies
            begin_at_rest(self._client, self.bodies, settled=settled)
            self._stands.enter()
        except BaseException:
            self.close()
            raise
        self._contents = self._make_contents()

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
        actions = StepActions(self._client, pushed, self.frustum_planes)
        for _ in range(count):
            actions.act(self._step / STEPS_PER_SECOND)
            self._stands.before_step(self.sim_time_ns)
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
        """What exists now, apart from poses."""
        return self._contents

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
            self._light_lamps(poses)
            self._snapshot = WorldSnapshot(
                sim_time_ns=self.sim_time_ns,
                step=self._step,
                contents=self._contents,
                world_from_body=poses,
                histories=self._bodies.histories(),
            )
        return self._snapshot

    def states(self) -> InstanceStates:
        """Return poses and velocities of all instances; the same object until something changes."""
        snapshot = self.snapshot()
        if self._states is None:
            self._states = self._bodies.states(snapshot.world_from_body)
        return self._states

    def mover(self, name: str) -> Mover:
        """Find a mover; the empty name means the scene's first.

        Raises
        ------
        UnknownName
        """
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

    def gaze(self, look_at: LookAt) -> Gaze:
        """Return a look-at constraint in this world.

        Raises
        ------
        UnknownName
            If no object of that name is there or waits.
        """
        return Gaze(self._bodies, look_at)

    def object_state(self, instance_id: int) -> ObjectState:
        """Return what and where an object, or a part of one, is now.

        Raises
        ------
        InvalidRequest
            If no instance has that id now.
        """
        piece = self._bodies.piece(instance_id)
        drawn = self._drawn(piece)
        model = drawn.model if piece.part else piece.body.placement.asset.model
        return piece.body.state(drawn.instance, self.sim_time_ns, model)

    def contacts(self, seconds: float = 0.0) -> tuple[Contact, ...]:
        """Return what touched what in the last step, and in so much simulated time before [s].

        The first question hears of the last step alone: each step is kept only after it.
        """
        ids = {(body.bullet_id, body.link): id_ for id_, body in self._bodies.items()}
        count = max(1, round(seconds * STEPS_PER_SECOND))
        return self._contact_log.contacts(self._step, count, ids, self._stands.pieces)

    @property
    def waiting(self) -> WaitingRoom:
        """The objects that are nowhere now; read-only."""
        return self._bodies.waiting

    # -- what is changed -------------------------------------------------------------------

    def enter(self, instance_id: int, *, seed: int) -> None:
        """Put an object that waits where it stands at the start; its behaviours begin now."""
        now_s = self._step / STEPS_PER_SECOND
        self._bodies.enter(instance_id, seed=seed, start_s=now_s)
        self._moved_in_or_out(self._bodies[instance_id].placement)

    def require_free(self, instance_id: int) -> None:
        """Refuse to let an object come and go that joints hold.

        Raises
        ------
        InvalidRequest
            If it is on a joint, or something is on a joint of its own on it.
        """
        self._bodies.require_free(instance_id)

    def leave(self, instance_id: int) -> None:
        """Take an object out of the world; it keeps its id and waits until it may `enter`."""
        placement = self._bodies[instance_id].placement
        self._bodies.leave(instance_id)
        self._moved_in_or_out(placement)

    def wait_as(self, instance_id: int, placement: Placement) -> None:
        """Let an object that waits enter as another placement says."""
        self._bodies.waiting.take(instance_id, placement)

    def spawn(self, placement: Placement) -> int:
        """Put one more object into the world.

        Returns
        -------
        instance_id : int
            Never used before in this world.

        Raises
        ------
        NameTaken
            If an object of that name is there.
        """
        instance_id = self._bodies.add(placement)
        self._changed_step = self._step
        self._changed()
        return instance_id

    def despawn(self, instance_id: int) -> None:
        """Take an object out of the world with its parts; their ids are not used again."""
        self._bodies.remove(instance_id)
        self._changed_step = self._step
        self._changed()

    def replace_body(
        self, instance_id: int, placement: Placement, described: SceneSpec | None = None
    ) -> None:
        """Make of an object what another placement says; it stays where it is, and its id too.

        It keeps its motion and its behaviours. Another scale cuts its past off: a point of its
        surface has no place of before.

        Parameters
        ----------
        instance_id : int
        placement : Placement
        described : SceneSpec or None
            What a scene file says of it all from now on; None leaves it.

        Raises
        ------
        NameTaken
            If another object has the placement's name.
        InvalidRequest
            If it cannot be such an object; it is as it was then.
        """
        old = self.body(instance_id)
        self._bodies.rebuild(instance_id, placement)
        if placement.scale != old.placement.scale:
            self._bodies.cut_off_past(instance_id)
            self._forget_chart(instance_id)
        self.described = described or self.described
        self._changed_step = self._step
        self._changed()

    def replace_room(
        self,
        placements: Iterable[Placement],
        described: SceneSpec,
        *,
        without: Collection[int] = (),
    ) -> None:
        """Exchange the parts of the room; all else stays where it is.

        Baked light was that of the old room and is taken off.

        Parameters
        ----------
        placements : iterable of Placement
            The parts that there shall be; one of the same name keeps its id.
        described : SceneSpec
            What a scene file says of it all from now on.
        without : collection of int
            Ids of objects whose places the parts take.

        Raises
        ------
        NameTaken, InvalidState
            If another object has the name of a part, or no ids are left; nothing is changed then.
        """
        self._bodies.replace_room(placements, without)
        for body in (*self._bodies, *self._stands.bodies):
            body.wake()
        self._baked = None
        self.described = described
        self._changed()

    def put_body(self, instance_id: int, pose: Pose, *, teleport: bool = False) -> None:
        """Move an object and stop it; `teleport` cuts its past off, so flow does not see a jump."""
        moved = self.body(instance_id)
        moved.require_free()
        self._bodies.rouse_beside(moved)
        moved.put(pose)
        self._bodies.joints.follow(moved)
        carried = set(self._bodies.joints.above(moved))
        if moved.placement.static:
            self._changed_step = self._step
        if teleport:
            for id_, body in self._bodies.items():
                if id_ == instance_id or body in carried:
                    self._bodies.cut_off_past(id_)
        self._snapshot = self._states = None

    def joint(self, instance_id: int) -> JointState | None:
        """Return the state of an object's joint; None where it has none that moves."""
        body = self.body(instance_id)
        return body.described_joint(instance_id) if isinstance(body, JointedBody) else None

    def joints(self) -> tuple[JointState, ...]:
        """Return the states of all joints that move, in the order of the objects' ids."""
        states = (self.joint(id_) for id_, _ in self._bodies.items())
        return tuple(state for state in states if state is not None)

    def set_joint(self, instance_id: int, position: float, seconds: float = 0.0) -> None:
        """Move the joint of an object to a position [rad] or [m], at once or within a time [s].

        Raises
        ------
        InvalidRequest
            If it has none that moves, the position is beyond its limits, or the time is not
            accepted; nothing is changed then.
        """
        body = self.body(instance_id)
        if not isinstance(body, JointedBody):
            names = [state.name for state in self.joints()]
            accepted = f"one on a joint: {', '.join(names[:20]) or 'this scene has none'}"
            raise InvalidRequest("object", body.placement.name, accepted)
        body.set_joint(position, seconds, self._step / STEPS_PER_SECOND)
        self._bodies.rouse_beside(body)
        if not seconds:
            self._changed_step = self._step
        self._snapshot = self._states = None

    def drive(
        self,
        mover: str,
        linear_m_s: Any = (0.0, 0.0, 0.0),
        angular_rad_s: Any = (0.0, 0.0, 0.0),
    ) -> None:
        """Have a mover walk, stopped by what it meets; see `MoverCommand` for the velocities.

        Raises
        ------
        UnknownName, InvalidRequest, InvalidState
            If there is no such mover, the command cannot be accepted, or waypoints drive it.
        """
        command = MoverCommand(linear_m_s=linear_m_s, angular_rad_s=angular_rad_s)
        self._stands.drive(mover, command, self.sim_time_ns)

    def embody(self, mover: str, rigid: RigidBody | None) -> bool:
        """Make a mover a rigid body, or none any more; return whether that changed anything.

        It stays where it is. One that is another body already keeps its motion and what pushes it.

        Raises
        ------
        UnknownName, InvalidState
            If there is no such mover, or waypoints drive it; nothing is changed then.
        """
        return self._stands.embody(mover, rigid, self.sim_time_ns)

    def set_lights(self, lights: Sequence[Light]) -> None:
        """Replace the lights."""
        self._lights = tuple(lights)
        self._changed()

    def set_environment(self, environment: Environment) -> None:
        """Replace ambient light, background and exposure."""
        self._environment = environment
        self._changed()

    def set_baked(self, baked: BakedLight | None) -> None:
        """Replace the light that was worked out beforehand for what stands still."""
        self._baked = baked and replace(baked, environment=self._environment)
        self._changed()

    @property
    def gravity(self) -> tuple[float, float, float]:
        """Acceleration that pulls every body with gravity, world frame [m/s²]."""
        return self._client.gravity

    def set_gravity(self, gravity: tuple[float, float, float]) -> None:
        """Change the acceleration that pulls every body with gravity; what sleeps wakes."""
        for body in (*self.bodies, *self._stands.bodies):
            body.wake()
        self._client.gravity = gravity  # bodies that sleep would keep the old one

    def close(self) -> None:
        """Free the engine; a second call does nothing."""
        self._client.close()

    # -- inside ----------------------------------------------------------------------------

    def _configure(self) -> None:
        client = self._client
        client.setTimeStep(1.0 / STEPS_PER_SECOND)
        client.setPhysicsEngineParameter(
            # Without it the order of contacts, and with it the result, may depend on addresses.
            deterministicOverlappingPairs=1,
            numSolverIterations=50,
            # Iterations end where they change nothing any more: most do after a few.
            solverResidualThreshold=SOLVER_RESIDUAL,
            warmStartingFactor=WARM_STARTING,
        )

    def _moved_in_or_out(self, placement: Placement) -> None:
        if placement.static:
            self._changed_step = self._step
        self._changed()

    def _forget_chart(self, instance_id: int) -> None:
        """Take the baked light off an instance whose surface is another now."""
        if self._baked is not None:
            gone = self._bodies.ids_of(instance_id)
            charts = {id_: c for id_, c in self._baked.charts.items() if id_ not in gone}
            self._baked = replace(self._baked, charts=charts)

    def _changed(self) -> None:
        self._contents = self._make_contents()
        self._snapshot = self._states = None

    def _light_lamps(self, poses: NDArray[np.float64]) -> None:
        """Find the lights that are in lamps now, some of which may have been moved."""
        found = lit_by(self._bodies.pieces, poses, self._lights)
        if found != self._lit_by:
            self._lit_by = found
            drawn = tuple(self._drawn(piece) for piece in self._bodies.pieces)
            self._contents = replace(self._contents, instances=drawn)

    def _make_contents(self) -> SceneContents:
        pieces = self._bodies.pieces
        self._lit_by = lit_by(pieces, self._bodies.world_from_body(), self._lights)
        return SceneContents(
            scene=self.scene,
            epoch=self.epoch,
            revision=self._next_revision(),
            instances=tuple(self._drawn(piece) for piece in pieces),
            categories=self.categories,
            lights=self._lights,
            environment=self._environment,
            baked=self._baked,
        )

    def _parent_of(self, placement: Placement) -> int:
        """Return the id of the object that one is a part of; 0 if there is none (any more)."""
        name = "" if placement.entry is None else placement.entry.part_of
        if not name and placement.joint is not None:
            name = placement.joint.parent
        return self._bodies.id_of_name(name) if name else 0

    def _drawn(self, piece: LabelledPiece) -> DrawnInstance:
        placement = piece.body.placement
        asset, part, category_id = placement.asset, piece.part, placement.category_id
        model, name, parent = asset.body_model, asset.name, self._parent_of(placement)
        keypoints = asset.keypoints
        if part is not None:
            model, name, parent = (
                asset.part_model(part),
                f"{name}{PART_MARK}{part.name}",
                piece.body_id,
            )
            category_id, keypoints = self.categories.named(part.category).id, ()
        low, high = model.bounds().tolist()
        instance = Instance(
            id=piece.id,
            name=piece.name,
            asset=name,
            category_id=category_id,
            category=self.categories[category_id].name,
            static=placement.static,
            low_m=_scaled(low, placement.scale),
            high_m=_scaled(high, placement.scale),
            parent=parent,
            materials=_material_names(placement) if part is None else (),
            painted=_painted(placement, self.described) if part is None else "",
            keypoints=tuple(
                Keypoint(name=point, position_m=_scaled(place, placement.scale))
                for point, place in keypoints
            ),
        )
        return DrawnInstance(
            instance=instance,
            model=model,
            scale=placement.scale,
            lit_by=self._lit_by.get(piece.body_id, ()),
            stands=placement.static or (placement.joint is not None and not placement.behaviours),
        )


def _material_names(placement: Placement) -> tuple[str, ...]:
    """Return the names of an object's own materials; none of a part of a room."""
    if placement.entry is None:
        return ()
    return placement.materials


def _painted(placement: Placement, described: SceneSpec | None) -> str:
    """Return as JSON what a scene file says of an object's materials; empty for the asset's own."""
    if placement.entry is not None:
        entries = [m.model_dump(mode="json", exclude_unset=True) for m in placement.entry.materials]
        return json.dumps(entries, sort_keys=True) if entries else ""
    look = None if described is None else described.room and described.room.look_of(placement.name)
    return "" if not look else json.dumps([look], sort_keys=True)


def _walls_of(room: RoomSpec | None) -> tuple[object, ...] | None:
    """Return what decides where things at a room's walls stand."""
    return None if room is None else (room.size, room.skirting and room.skirting.depth)


def _scaled(point: Sequence[float], scale: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (float(a) * float(b) for a, b in zip(point, scale, strict=True))
    return x, y, z
