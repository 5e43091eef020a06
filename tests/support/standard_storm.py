"""Random calls of ROS's standard interfaces, each answer compared with a model of the simulator.

The same seed makes the same calls; the digest of all answers tells whether two runs were equal.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import Any

from simulation_interfaces import srv
from simulation_interfaces.msg import (
    EntityCategory,
    EntityFilters,
    EntityInfo,
    Resource,
    Result,
    SimulationState,
    SpawnEntity,
    TagsFilter,
)

from tests.support.robot_files import ARM
from tests.support.standard_client import (
    OK,
    StandardClient,
    set_resource,
    spawn_request,
    world,
)

__all__ = ["storm"]

NOT_FOUND, FAILED = Result.RESULT_NOT_FOUND, Result.RESULT_OPERATION_FAILED
UNSUPPORTED, STATE = Result.RESULT_FEATURE_UNSUPPORTED, Result.RESULT_INCORRECT_STATE
STOPPED, PLAYING = SimulationState.STATE_STOPPED, SimulationState.STATE_PLAYING
PAUSED, NO_WORLD = SimulationState.STATE_PAUSED, SimulationState.STATE_NO_WORLD
STEP_NS = 1e9 / 240

WORLDS = ("optical", "solid_benchmark", "void")
NAMES = ("a", "b", "c", "a_1")
SPACES = ("", "", "r1", "r1/deep")
MOST_SPAWNED, MOST_ROBOTS = 6, 2
LINKS = ("base", "upper", "lower", "left", "right")


@dataclass
class Model:
    """A lockstep simulator, as far as answers follow from it."""

    own: dict[str, frozenset[str]]
    state: int = PAUSED
    scene: str = "optical"
    steps: int = 0
    gone: set[str] = field(default_factory=set)
    spawned: list[str] = field(default_factory=list)
    robots: list[str] = field(default_factory=list)
    tagged: dict[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def links(self) -> set[str]:
        return {f"{robot} {link}" for robot in self.robots for link in LINKS}

    @property
    def entities(self) -> set[str]:
        if self.state == NO_WORLD:
            return set()
        there = set(self.own[self.scene]) - self.gone
        return there | set(self.spawned) | set(self.robots) | self.links

    def begin(self, scene: str, state: int) -> None:
        self.scene, self.state, self.steps = scene, state, 0
        self.gone, self.spawned, self.robots, self.tagged = set(), [], [], {}

    def remove(self, name: str) -> None:
        self.spawned = [one for one in self.spawned if one != name]
        self.gone |= {name} & self.own[self.scene]
        for one in (name, *(f"{name} {link}" for link in LINKS if name in self.robots)):
            self.tagged.pop(one, None)
        self.robots = [one for one in self.robots if one != name]


def storm(call: StandardClient, *, seed: int, calls: int) -> tuple[str, dict[str, int]]:
    """Make random calls; return the digest of all answers, and how many there were of each.

    Raises
    ------
    AssertionError
        If an answer is not that of the model.
    """
    return _Storm(call, seed).run(calls)


class _Storm:
    def __init__(self, call: StandardClient, seed: int) -> None:
        self._call = call
        self._random = random.Random(seed)
        self._digest = blake2b(digest_size=16)
        self._counts: dict[str, int] = {}
        own = {}
        for scene in WORLDS:
            call("LoadWorld", **world(scene))
            own[scene] = frozenset(call.entities())
        self._model = Model(own)
        call("LoadWorld", **world("optical"))
        call.set_to(PAUSED)

    def run(self, calls: int) -> tuple[str, dict[str, int]]:
        acts = [getattr(self, name) for name in sorted(dir(self)) if name.startswith("_do_")]
        for _ in range(calls):
            self._random.choice(acts)()
        return self._digest.hexdigest(), self._counts

    def _send(self, kind: str, code: int, request: Any = None, **fields: Any) -> Any:
        """Call a service that needs a world unless the code says otherwise."""
        made = getattr(srv, kind).Request(**fields) if request is None else request
        answer = self._call.send(kind, made, code)
        self._counts[kind] = self._counts.get(kind, 0) + 1
        self._digest.update(repr(answer).encode())
        return answer

    def _of_world(self, kind: str, code: int, request: Any = None, **fields: Any) -> Any:
        """Call a service that is refused while there is no world."""
        refused = self._model.state == NO_WORLD
        answer = self._send(kind, STATE if refused else code, request, **fields)
        return None if refused else answer

    def _name(self) -> str:
        """Return the name of an entity, of which one in five is not there."""
        there = sorted(self._model.entities)
        if there and self._random.random() < 0.8:
            return self._random.choice(there)
        return self._random.choice(("nobody", *NAMES))

    def _found(self, name: str) -> int:
        return int(OK if name in self._model.entities else NOT_FOUND)

    def _place(self) -> tuple[float, float, float]:
        x, y = (self._random.uniform(-200.0, 200.0) for _ in "xy")
        return x, y, self._random.uniform(20.0, 300.0)

    # -- entities --------------------------------------------------------------------------

    def _do_spawn_entity(self) -> None:
        if len(self._model.spawned) >= MOST_SPAWNED:
            self._do_delete_entity()
            return
        name, space = self._random.choice((*NAMES, "", "a/b")), self._random.choice(SPACES)
        rename = self._random.random() < 0.5
        request = spawn_request(
            name, "cube", entity_namespace=space, allow_renaming=rename, at=self._place()
        )
        code, full = self._naming(name, space, rename)
        answer = self._of_world("SpawnEntity", code, request)
        if answer is not None and code == OK:
            assert answer.entity_name == full
            self._model.spawned.append(full)

    def _do_spawn_robot(self) -> None:
        if len(self._model.robots) >= MOST_ROBOTS:
            self._do_delete_entity()
            return
        name, space = self._random.choice((*NAMES, "")), self._random.choice(SPACES)
        rename = self._random.random() < 0.5
        request = spawn_request(
            name, "", entity_namespace=space, allow_renaming=rename, at=self._place()
        )
        set_resource(request, text=ARM)
        # A name that is not given is that of the file.
        code, full = self._naming(name or "arm", space, rename)
        answer = self._of_world("SpawnEntity", code, request)
        if answer is not None and code == OK:
            assert answer.entity_name == full
            self._model.robots.append(full)

    def _do_set_state_of_robot(self) -> None:
        if self._model.robots and self._model.state != NO_WORLD:
            name = self._random.choice(self._model.robots)
            self._call.set_state(name, self._call.state(name), FAILED)  # it is fixed

    def _naming(self, name: str, space: str, rename: bool) -> tuple[int, str]:
        code, prefix = srv.SpawnEntity.Response, f"{space}/" if space else ""
        if "/" in name or (not name and not rename):
            return int(code.NAME_INVALID), ""
        there = self._model.entities
        if name and prefix + name not in there:
            return int(OK), prefix + name
        if not rename:
            return int(code.NAME_NOT_UNIQUE), ""
        numbers = range(1, 100)
        free = (f"{prefix}{name or 'cube'}_{number}" for number in numbers)
        return int(OK), next(one for one in free if one not in there)

    def _do_spawn_entities(self) -> None:
        if len(self._model.spawned) >= MOST_SPAWNED:
            self._do_delete_entity()
            return
        names = [self._random.choice(NAMES) for _ in range(2)]
        wanted = []
        for name in names:
            one = SpawnEntity(name=name, entity_resource=Resource(uri="cube"))
            place = one.initial_pose.pose.position
            place.x, place.y, place.z = self._place()
            wanted.append(one)
        new = [name for name in dict.fromkeys(names) if name not in self._model.entities]
        code = OK if len(new) == 2 else srv.SpawnEntities.Response.ENTITIES_SPAWN_FAILED
        if self._of_world("SpawnEntities", code, spawn_requests=wanted) is not None:
            self._model.spawned += new

    def _do_delete_entity(self) -> None:
        name = self._name()
        code = FAILED if name in self._model.links else self._found(name)
        if self._of_world("DeleteEntity", code, entity=name) is not None and code == OK:
            self._model.remove(name)

    def _do_get_entities(self) -> None:
        answer = self._of_world("GetEntities", OK)
        if answer is not None:
            assert set(answer.entities) == self._model.entities
            assert len(answer.entities) == len(self._model.entities)

    def _do_get_tagged(self) -> None:
        filters = EntityFilters(tags=TagsFilter(tags=[self._random.choice("xyz")]))
        answer = self._of_world("GetEntities", OK, filters=filters)
        if answer is not None:
            (tag,) = filters.tags.tags
            wanted = {name for name, tags in self._model.tagged.items() if tag in tags}
            assert set(answer.entities) == wanted

    def _do_get_entities_states(self) -> None:
        answer = self._of_world("GetEntitiesStates", OK)
        if answer is not None:
            assert set(answer.entities) == self._model.entities
            assert len(answer.states) == len(answer.entities)
            for state in answer.states:
                self._check_stamp(state)

    def _do_get_entity_state(self) -> None:
        name = self._name()
        code = self._found(name)
        answer = self._of_world("GetEntityState", code, entity=name)
        if answer is not None and code == OK:
            self._check_stamp(answer.state)

    def _check_stamp(self, state: Any) -> None:
        stamp = state.header.stamp
        now_ns = stamp.sec * 10**9 + stamp.nanosec
        assert abs(now_ns - self._model.steps * STEP_NS) <= 1.0

    def _do_set_entity_state(self) -> None:
        name = self._random.choice((*self._model.spawned, "nobody"))
        if self._model.state == NO_WORLD or name == "nobody":
            self._of_world("SetEntityState", NOT_FOUND, entity="nobody")
            return
        state = self._call.state(name)
        place = state.pose.position
        place.x, place.y, place.z = self._place()
        state.twist.linear.x = self._random.uniform(-2.0, 2.0)
        state.acceleration.linear.x = 0.0  # that would be asked for, too
        self._call.set_state(name, state)
        told = self._send("GetEntityState", OK, entity=name).state
        assert abs(told.pose.position.x - place.x) < 1e-9
        assert abs(told.twist.linear.x - state.twist.linear.x) < 1e-9

    def _do_set_entity_info(self) -> None:
        name = self._name()
        category = self._random.choice((EntityCategory.CATEGORY_ROBOT, 3))
        tags = tuple(self._random.sample("xyz", 2))
        info = EntityInfo(category=EntityCategory(category=category), tags=list(tags))
        code = self._found(name)
        if code == OK and category == 3:
            code = FAILED
        answer = self._of_world("SetEntityInfo", code, entity=name, info=info)
        if answer is not None and code == OK:
            self._model.tagged[name] = tags

    def _do_get_entity_info(self) -> None:
        name = self._name()
        code = self._found(name)
        answer = self._of_world("GetEntityInfo", code, entity=name)
        if answer is not None and name in self._model.tagged and code == OK:
            assert tuple(answer.info.tags) == self._model.tagged[name]

    def _do_get_entity_bounds(self) -> None:
        name = self._name()
        self._of_world("GetEntityBounds", self._found(name), entity=name)

    # -- time and worlds -------------------------------------------------------------------

    def _do_step_simulation(self) -> None:
        steps = self._random.randint(0, 5)
        code = OK if steps and self._model.state == PAUSED else FAILED
        if self._of_world("StepSimulation", code, steps=steps) is not None and code == OK:
            self._model.steps += steps

    def _do_reset_simulation(self) -> None:
        scope = self._random.choice((0, 1, 2, 4, 6, 8, 255))
        code = UNSUPPORTED if scope in (1, 8) else OK
        if self._of_world("ResetSimulation", code, scope=scope) is None or code != OK:
            return
        if scope in (0, 255):
            self._model.begin(self._model.scene, self._model.state)
        elif scope & 4:
            for name in (*self._model.spawned, *self._model.robots):
                self._model.remove(name)

    def _do_set_simulation_state(self) -> None:
        code, model = srv.SetSimulationState.Response, self._model
        target = self._random.choice((STOPPED, PLAYING, PAUSED, PAUSED, NO_WORLD))
        wanted = SimulationState(state=target)
        if target == model.state:
            expected = code.ALREADY_IN_TARGET_STATE
        elif target == NO_WORLD:
            expected = code.INCORRECT_TRANSITION
        elif model.state == NO_WORLD:
            expected = STATE
        elif target == PLAYING:
            expected = code.STATE_TRANSITION_ERROR
        else:
            expected = OK
        self._send("SetSimulationState", expected, state=wanted)
        if expected == OK and target == STOPPED:
            model.begin(model.scene, STOPPED)
        elif expected == OK:
            model.state = target

    def _do_get_simulation_state(self) -> None:
        assert self._send("GetSimulationState", OK).state.state == self._model.state

    def _do_load_world(self) -> None:
        scene = self._random.choice((*WORLDS, "no_such_scene"))
        code = OK if scene in WORLDS else NOT_FOUND
        self._send("LoadWorld", code, **world(scene))
        if code == OK:
            self._model.begin(scene, STOPPED)
            self._send("SetSimulationState", OK, state=SimulationState(state=PAUSED))
            self._model.state = PAUSED

    def _do_unload_world(self) -> None:
        loaded = self._model.state != NO_WORLD
        code = OK if loaded else srv.UnloadWorld.Response.NO_WORLD_LOADED
        self._send("UnloadWorld", code)
        self._model.begin("void", NO_WORLD)

    def _do_get_current_world(self) -> None:
        loaded = self._model.state != NO_WORLD
        code = OK if loaded else srv.GetCurrentWorld.Response.NO_WORLD_LOADED
        answer = self._send("GetCurrentWorld", code)
        if loaded:
            assert answer.world.name == self._model.scene

    # -- what there is to have -------------------------------------------------------------

    def _do_get_catalogue(self) -> None:
        kind = self._random.choice(("GetSimulatorFeatures", "GetAvailableWorlds", "GetSpawnables"))
        self._send(kind, OK)

    def _do_get_named_poses(self) -> None:
        answer = self._of_world("GetNamedPoses", OK)
        if answer is not None and answer.poses:
            name = self._random.choice(answer.poses).name
            self._of_world("GetNamedPoseBounds", OK, name=name)
