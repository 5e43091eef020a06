"""ROS's standard interfaces of simulators over real DDS: each service, its codes, the action."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Vector3
from rclpy.action.client import ActionClient
from simulation_interfaces import srv
from simulation_interfaces.action import SimulateSteps
from simulation_interfaces.msg import (
    Bounds,
    EntityCategory,
    EntityFilters,
    Resource,
    Result,
    SimulationState,
    SimulatorFeatures,
    SpawnEntity,
    TagsFilter,
)

from sailenv_msgs_py.transforms import pose_from_msg
from sailenv_ros.ros.nodes.simulation_interfaces.table import ROWS
from tests.support.robot_files import ARM, CART
from tests.support.ros_probe import RELIABLE, Probe
from tests.support.sim_node_process import NodeProcess
from tests.support.standard_client import StandardClient, set_resource, spawn_request, world
from tests.support.standard_storm import storm
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/standard"
OK, NOT_FOUND, FAILED = Result.RESULT_OK, Result.RESULT_NOT_FOUND, Result.RESULT_OPERATION_FAILED
UNSUPPORTED, STATE = Result.RESULT_FEATURE_UNSUPPORTED, Result.RESULT_INCORRECT_STATE


@pytest.fixture(scope="module")
def node() -> Iterator[NodeProcess]:
    """A lockstep simulator."""
    with NodeProcess(
        NAMESPACE, mode="lockstep", agent__width=64, agent__height=48, agent__rate_hz=0.0
    ) as node:
        yield node


@pytest.fixture
def call(probe: Probe) -> StandardClient:
    """A client; the scene stands at its beginning and is paused."""
    client = StandardClient(probe)
    client("LoadWorld", **world("optical"))
    client.set_to(SimulationState.STATE_PAUSED)
    return client


def test_everything_is_offered_and_announced(call: StandardClient) -> None:
    """22 services and the action; each feature is a constant, none of time alone."""
    kinds = {row.type_name for row in ROWS} | {"GetSimulatorFeatures"}
    assert len(kinds) == 22
    assert kinds == {name for name in dir(srv) if name[0].isupper() and "_" not in name}
    features = call("GetSimulatorFeatures").features
    named = {name: getattr(SimulatorFeatures, name) for name in dir(SimulatorFeatures)}
    constants = {name: value for name, value in named.items() if isinstance(value, int)}
    missing = {"SIMULATION_RESET_TIME", "WORLD_RESOURCE_STRING"}
    assert missing < constants.keys()
    assert set(features.features) == {
        number for name, number in constants.items() if name not in missing
    }
    assert list(features.spawn_formats) == ["sailenv", "urdf", "mjcf"]
    call("ResetSimulation", UNSUPPORTED, scope=srv.ResetSimulation.Request.SCOPE_TIME)
    call("LoadWorld", UNSUPPORTED, **world(text="version: 1"))


def test_entities_come_and_go(call: StandardClient) -> None:
    """Names, namespaces, renaming; an old name is free again after it was deleted."""
    code = srv.SpawnEntity.Response
    assert call.spawn("box") == "box"
    call.spawn("box", code=code.NAME_NOT_UNIQUE, at=(44.0, 0.0, 50.0))
    assert call.spawn("box", allow_renaming=True, at=(46.0, 0.0, 50.0)) == "box_1"
    assert call.spawn("", allow_renaming=True, at=(48.0, 0.0, 50.0)) == "cube_1"
    assert call.spawn("box", entity_namespace="/robot1", at=(50.0, 0, 50)) == "robot1/box"
    assert call.spawn("box", entity_namespace="robot1", allow_renaming=True) == "robot1/box_1"
    call.spawn("", code=code.NAME_INVALID)
    call.spawn("a/b", code=code.NAME_INVALID)
    call.spawn("\N{SNOWMAN}", code=code.NAME_INVALID)
    call.spawn("other", entity_namespace="1st", code=code.NAMESPACE_INVALID)
    call.spawn("other", asset="", code=code.NO_RESOURCE)
    call.spawn("other", asset="no such thing", code=NOT_FOUND)
    call.spawn("other", at=(math.nan, 0.0, 0.0), code=code.INVALID_POSE)
    assert call.entities(filter="^robot1/") == ["robot1/box", "robot1/box_1"]
    call("DeleteEntity", entity="robot1/box")
    call("DeleteEntity", NOT_FOUND, entity="robot1/box")
    assert call.spawn("box", entity_namespace="robot1") == "robot1/box"
    assert "other" not in call.entities()


def test_an_object_of_a_scene_file_is_spawned_by_its_text(call: StandardClient) -> None:
    """With its mass and its colour; what is none is refused, whatever it asks for."""
    code = srv.SpawnEntity.Response

    def spawn(text: str, name: str = "") -> Any:
        request = srv.SpawnEntity.Request(name=name)
        set_resource(request, text=text)
        return call.send("SpawnEntity", request, None)

    answer = spawn("{name: heavy, asset: cube, mass: 7, colour: '#ff0000', static: true}")
    assert (answer.result.result, answer.entity_name) == (OK, "heavy")
    info = call("GetEntityInfo", entity="heavy").info
    assert info.category.category == EntityCategory.CATEGORY_STATIC_OBJECT
    assert spawn("{asset: [", "x").result.result == code.RESOURCE_PARSE_ERROR
    assert spawn("{scale: 2}", "x").result.result == code.UNSUPPORTED_FORMAT
    assert spawn("{asset: cube, masss: 7}", "x").result.result == code.RESOURCE_PARSE_ERROR
    hostile = "{asset: cube, behaviours: [{type: 'os:system'}]}"
    assert spawn(hostile, "x").result.result == code.RESOURCE_PARSE_ERROR


def test_robots_come_and_go_with_their_links(call: StandardClient, tmp_path: Path) -> None:
    """One entity each, and one for each link; by a text, a file, or as scene files have them."""
    code = srv.SpawnEntity.Response

    def spawn(name: str = "", code: int | None = OK, **resource: str) -> str:
        request = srv.SpawnEntity.Request(name=name)
        request.initial_pose.pose.position.z = 40.0
        set_resource(request, **resource)
        return str(call.send("SpawnEntity", request, code).entity_name)

    def robots() -> list[str]:
        wanted = EntityCategory(category=EntityCategory.CATEGORY_ROBOT)
        return call.entities(categories=[wanted])

    assert spawn(text=ARM) == "arm"
    links = ["arm base", "arm upper", "arm lower", "arm left", "arm right"]
    assert call.entities(filter="^arm") == ["arm", *links]
    assert robots() == ["arm"]
    assert call("GetEntityInfo", entity="arm").info.tags == ["robot", "arm", "spawned"]
    assert call.state("arm").pose == call.state("arm base").pose
    high, low = call("GetEntityBounds", entity="arm").bounds.points
    assert (high.z, low.z) == pytest.approx((1.12, 0.0), abs=1e-6)
    assert (high.x, low.x) == pytest.approx((0.15, -0.15))
    ball = Bounds(type=Bounds.TYPE_SPHERE, points=[Vector3(z=41.0), Vector3(x=0.01)])
    assert call.entities(bounds=ball) == ["arm", "arm lower"]
    call("DeleteEntity", FAILED, entity="arm upper")
    call.set_state("arm", call.state("arm"), FAILED)  # it is fixed
    spawn("arm", code.NAME_NOT_UNIQUE, text=ARM)
    spawn("arm upper", code.NAME_NOT_UNIQUE, uri="cube")
    call("DeleteEntity", entity="arm")
    call("DeleteEntity", NOT_FOUND, entity="arm")
    assert call.entities(filter="^arm") == []
    path = tmp_path / "cart.urdf"
    path.write_text(CART, encoding="utf-8")
    assert spawn(uri=f"file://{path}") == "cart"
    rolling = f"{{file: '{path}', mount: differential}}"
    assert spawn("second", text=rolling) == "second"
    moved = call.state("second")
    moved.pose.position.x, moved.twist.linear.x = 5.0, 0.5
    call.set_state("second", moved)
    assert call.state("second chassis").pose.position.x == 5.0
    assert call.state("second").twist.linear.x == pytest.approx(0.5)
    for _ in range(2):
        call("ResetSimulation", scope=srv.ResetSimulation.Request.SCOPE_SPAWNED)
        assert robots() == []
        assert spawn("cart", uri=str(path)) == "cart"
    call("ResetSimulation")
    assert spawn("cart", uri=str(path)) == "cart"
    arm = spawn_request("cart", "", entity_namespace="one", at=(0.0, 3.0, 40.0))
    set_resource(arm, text=ARM)
    assert call.send("SpawnEntity", arm).entity_name == "one/cart"
    assert robots() == ["cart", "one/cart"]
    assert call.entities(filter="^one/cart ")[0] == "one/cart base"
    spawn("x", NOT_FOUND, uri="package://../../etc/passwd.urdf")
    spawn("x", NOT_FOUND, uri="file:///nowhere/arm.urdf")
    bomb = '<!DOCTYPE r [<!ENTITY a "b"><!ENTITY c "&a;&a;">]><robot name="r"/>'
    many = "".join(f'<link name="a{n}"/>' for n in range(10_000))
    no_number = ARM.replace('value="1.0"', 'value="nan"')
    loop = ARM.replace('<child link="upper"/>', '<child link="base"/>')
    for text in ("<robot name='r2'/>", f'<robot name="r">{many}</robot>', bomb, no_number, loop):
        spawn("x", code.RESOURCE_PARSE_ERROR, text=text)
    mesh = '<visual><geometry><mesh filename="package://../../m.obj"/></geometry></visual>'
    bare = f"<robot name='r'><link name='a'>{mesh}</link></robot>"
    spawn("x", code.MISSING_ASSETS, text=bare)
    spawn("x", code.RESOURCE_PARSE_ERROR, text=f"{{file: '{path}', mount: flying}}")
    assert robots() == ["cart", "one/cart"]


def test_several_are_spawned_in_one_call(call: StandardClient) -> None:
    """Each for itself: those that can be are there, the others have their codes."""
    wanted = []
    for name, asset in (("one", "cube"), ("one", "cube"), ("two", "sphere")):
        wanted.append(SpawnEntity(name=name, entity_resource=Resource(uri=asset)))
        wanted[-1].initial_pose.pose.position.z = 10.0 * len(wanted)
    failed = srv.SpawnEntities.Response.ENTITIES_SPAWN_FAILED
    answer = call("SpawnEntities", failed, spawn_requests=wanted)
    codes = [one.result.result for one in answer.results]
    assert codes == [OK, srv.SpawnEntity.Response.NAME_NOT_UNIQUE, OK]
    assert {"one", "two"} <= set(call.entities())


def test_states_are_set_and_told(call: StandardClient) -> None:
    """Pose and velocities of the frame's origin, also in another entity's frame."""
    call.spawn("carrier", at=(40.0, 0.0, 50.0))
    call.spawn("thing", at=(42.0, 0.0, 60.0))
    turned = call.state("carrier")
    turned.pose.orientation.z = turned.pose.orientation.w = math.sqrt(0.5)
    call.set_state("carrier", turned)
    state = call.state("thing")
    state.header.frame_id = "carrier"
    state.pose.position.x, state.pose.position.y, state.pose.position.z = 1.0, 0.0, 5.0
    state.twist.linear.x, state.twist.angular.z = 2.0, 0.5
    call.set_state("thing", state)
    told = call.state("thing")
    place, speed = told.pose.position, told.twist.linear
    assert (place.x, place.y, place.z) == pytest.approx((40.0, 1.0, 55.0))
    assert (speed.x, speed.y, speed.z) == pytest.approx((0.0, 2.0, 0.0), abs=1e-12)
    assert told.twist.angular.z == pytest.approx(0.5)
    assert told.header.frame_id == "world"
    call("StepSimulation", steps=24)
    moved = call.state("thing")
    assert moved.pose.position.y - place.y == pytest.approx(0.2, rel=0.02)
    assert moved.header.stamp.nanosec - told.header.stamp.nanosec == 100_000_000
    both = call("GetEntitiesStates", filters=EntityFilters(filter="^(carrier|thing)$"))
    assert list(both.entities) == ["carrier", "thing"]
    assert both.states[1] == moved
    invalid = srv.SetEntityState.Response.INVALID_POSE
    wrong = call.state("thing")
    wrong.pose.orientation.w = 3.0
    call.set_state("thing", wrong, invalid)
    wrong = call.state("thing")
    wrong.header.frame_id = "nowhere"
    call.set_state("thing", wrong, invalid)
    falling = call.state("thing")
    assert falling.acceleration.linear.z == pytest.approx(-9.81, rel=0.01)
    call.set_state("thing", falling)  # what was told can be set
    floor = call.state("floor")
    floor.twist.linear.x = 1.0
    call.set_state("floor", floor, FAILED)
    call("GetEntityState", NOT_FOUND, entity="nobody")
    assert call.state("thing").pose == moved.pose
    assert call.state("thing").twist == moved.twist


def test_information_can_be_filtered_by(call: StandardClient) -> None:
    """Categories and tags, any or all; those that were set replace those that follow."""
    call.spawn("box")
    static = EntityCategory(category=EntityCategory.CATEGORY_STATIC_OBJECT)
    assert "floor" in call.entities(categories=[static])
    assert "box" not in call.entities(categories=[static])
    assert call.entities(tags=TagsFilter(tags=["spawned"])) == ["box"]
    info = call("GetEntityInfo", entity="box").info
    assert "cube" in info.tags
    info.category.category = EntityCategory.CATEGORY_ROBOT
    info.tags, info.description = ["mine", "red"], "a robot"
    call("SetEntityInfo", entity="box", info=info)
    assert call("GetEntityInfo", entity="box").info == info
    robots = [EntityCategory(category=EntityCategory.CATEGORY_ROBOT)]
    assert call.entities(categories=robots) == ["box"]
    every = TagsFilter(tags=["mine", "blue"], filter_mode=TagsFilter.FILTER_MODE_ALL)
    assert call.entities(tags=every) == []
    every.filter_mode = TagsFilter.FILTER_MODE_ANY
    assert call.entities(tags=every) == ["box"]
    info.category.category = 3
    call("SetEntityInfo", FAILED, entity="box", info=info)
    call("GetEntities", FAILED, filters=EntityFilters(filter="("))
    call("GetEntities", FAILED, filters=EntityFilters(tags=TagsFilter(filter_mode=7)))


def test_bounds_are_those_of_collision_shapes(call: StandardClient) -> None:
    """A cube of 1 m, its box in its own frame, and regions that touch it or do not."""
    call.spawn("box", at=(40.0, 0.0, 50.0))
    bounds = call("GetEntityBounds", entity="box").bounds
    assert bounds.type == Bounds.TYPE_BOX
    high, low = bounds.points
    assert (high.x, high.y, high.z) == pytest.approx((0.5, 0.5, 0.5))
    assert (low.x, low.y, low.z) == pytest.approx((-0.5, -0.5, -0.5))

    def found(kind: int, *points: tuple[float, float, float]) -> list[str]:
        corners = [Vector3(x=x, y=y, z=z) for x, y, z in points]
        return call.entities(bounds=Bounds(type=kind, points=corners))

    far, near = (41.5, 0.0, 50.0), (41.4, 0.0, 50.0)
    assert found(Bounds.TYPE_SPHERE, far, (0.99, 0.0, 0.0)) == []
    assert found(Bounds.TYPE_SPHERE, near, (0.91, 0.0, 0.0)) == ["box"]
    assert found(Bounds.TYPE_BOX, (43.0, 1.0, 51.0), (40.6, -1.0, 49.0)) == []
    assert found(Bounds.TYPE_BOX, (43.0, 1.0, 51.0), (40.4, -1.0, 49.0)) == ["box"]
    hull = ((41.0, 0.0, 49.0), (41.0, 0.0, 51.0), (43.0, 0.0, 50.0))
    assert found(Bounds.TYPE_CONVEX_HULL, *hull) == []
    assert found(Bounds.TYPE_CONVEX_HULL, (40.3, 0.0, 50.0), *hull) == ["box"]
    call("GetEntities", UNSUPPORTED, filters=EntityFilters(bounds=Bounds(type=9)))
    one = Bounds(type=Bounds.TYPE_BOX, points=[Vector3()])
    call("GetEntities", FAILED, filters=EntityFilters(bounds=one))


def test_the_catalogue_can_be_spawned(call: StandardClient) -> None:
    """Each spawnable has a URI that spawns it and the box that it fills."""
    answer = call("GetSpawnables", sources=["https://example.org"])
    assert "https://example.org" in answer.result.error_message
    uris = {getattr(one, "entity_resource", one).uri: one.spawn_bounds for one in answer.spawnables}
    high, _ = uris["sailenv://asset/sphere"].points
    assert high.x == pytest.approx(0.5)
    assert len(uris) == len(answer.spawnables) > 3


def test_named_poses_stay_where_they_are(call: StandardClient) -> None:
    """Viewpoints with what is free around them; the same ones each time."""
    poses = call("GetNamedPoses").poses
    assert poses == call("GetNamedPoses").poses
    assert len({one.name for one in poses}) == len(poses) > 0
    waypoints = call("GetNamedPoses", tags=TagsFilter(tags=["waypoint"])).poses
    assert all("waypoint" in one.tags for one in waypoints)
    bounds = call("GetNamedPoseBounds", name=poses[0].name).bounds
    assert (bounds.type, bounds.points[0]) == (Bounds.TYPE_SPHERE, Vector3())
    assert bounds.points[1].x > 0.0
    call("GetNamedPoseBounds", NOT_FOUND, name="nowhere")


# -- time ----------------------------------------------------------------------------------


def test_a_lockstep_simulation_is_paused_or_stopped(call: StandardClient) -> None:
    """It is stepped while paused; to stop it resets it; it cannot play."""
    code = srv.SetSimulationState.Response
    assert call.simulation_state == SimulationState.STATE_PAUSED
    call.spawn("box")
    call("StepSimulation")
    call("StepSimulation", steps=23)
    assert call.state("box").header.stamp.nanosec == 100_000_000
    call("StepSimulation", FAILED, steps=0)
    call.set_to(SimulationState.STATE_PAUSED, code.ALREADY_IN_TARGET_STATE)
    call.set_to(SimulationState.STATE_PLAYING, code.STATE_TRANSITION_ERROR)
    call.set_to(SimulationState.STATE_NO_WORLD, code.INCORRECT_TRANSITION)
    call.set_to(SimulationState.STATE_STOPPED)
    assert call.simulation_state == SimulationState.STATE_STOPPED
    assert "box" not in call.entities()
    assert call.state("floor").header.stamp.nanosec == 0
    call("StepSimulation", FAILED)
    call.set_to(SimulationState.STATE_STOPPED, code.ALREADY_IN_TARGET_STATE)
    call.set_to(SimulationState.STATE_PAUSED)
    call("StepSimulation")


def test_a_reset_has_scopes(call: StandardClient) -> None:
    """State and spawned things each for themselves, all together; old names are free again."""
    scope = srv.ResetSimulation.Request
    call.spawn("box", at=(40.0, 0.0, 50.0))
    begin = call("GetEntitiesStates", filters=EntityFilters(filter="cube"))
    assert begin.entities
    call("StepSimulation", steps=120)
    call("ResetSimulation", scope=scope.SCOPE_STATE)
    now = call("GetEntitiesStates", filters=EntityFilters(filter="cube"))
    for one, first in zip(now.states, begin.states, strict=True):
        before, after = pose_from_msg(first.pose), pose_from_msg(one.pose)
        assert after.position_m == before.position_m
        assert after.orientation_xyzw == pytest.approx(before.orientation_xyzw, abs=1e-15)
        assert one.twist == first.twist
    assert call.state("box").pose.position.z < 49.9
    assert call.state("box").header.stamp.nanosec == 500_000_000
    call("ResetSimulation", scope=scope.SCOPE_SPAWNED)
    assert "box" not in call.entities()
    assert call.spawn("box") == "box"
    call("ResetSimulation", UNSUPPORTED, scope=scope.SCOPE_TIME | scope.SCOPE_STATE)
    call("ResetSimulation", UNSUPPORTED, scope=8)
    for everything in (scope.SCOPE_DEFAULT, scope.SCOPE_ALL, 7):
        call("ResetSimulation", scope=everything)
        assert "box" not in call.entities()
        assert call.spawn("box") == "box"
        assert call.state("box").header.stamp.nanosec == 0


def test_steps_tell_how_far_they_are(call: StandardClient, probe: Probe) -> None:
    """Feedback after each step; a cancelled action ends between two; a stopped one is refused."""
    client = ActionClient(
        probe.node, SimulateSteps, "simulate_steps", feedback_sub_qos_profile=RELIABLE
    )
    until(client.server_is_ready, "the action")
    heard: list[Any] = []

    def begun(steps: int, timeout_s: float = 20.0) -> Any:
        send = partial(
            client.send_goal_async,
            SimulateSteps.Goal(steps=steps),
            feedback_callback=lambda message: heard.append(message.feedback),
        )
        return probe.ask(send, "the goal to be accepted", timeout_s)

    def ended(goal: Any, timeout_s: float = 20.0) -> Any:
        return probe.ask(goal.get_result_async, "the result", timeout_s)

    def stepped() -> bool:
        # DDS drops an answer whose reader the server has not found yet.
        with suppress(AssertionError):
            goal = begun(1, 2.0)
            until(lambda: heard, "feedback", 2.0)
            return ended(goal, 2.0).result.result.result == OK
        return False

    # That the action has found its listener is known from what it hears.
    until(stepped, "the first feedback")
    call("ResetSimulation")
    goal = begun(24)
    # First the feedback: rclpy forgets who listens as soon as it gives the result.
    until(lambda: heard[-1].completed_steps == 24, "the last feedback")
    assert ended(goal).result.result.result == OK
    told = [(one.completed_steps, one.remaining_steps) for one in heard]
    assert [steps for steps in told if sum(steps) == 24] == [(n, 24 - n) for n in range(1, 25)]
    assert call.state("floor").header.stamp.nanosec == 100_000_000
    heard.clear()
    goal = begun(1_000_000)
    until(lambda: heard and heard[-1].remaining_steps > 24, "feedback")
    probe.ask(goal.cancel_goal_async, "the answer to a cancellation")
    cancelled = ended(goal)
    assert cancelled.status == GoalStatus.STATUS_CANCELED
    assert cancelled.result.result.result == FAILED
    assert "of 1000000 steps" in cancelled.result.result.error_message
    assert ended(begun(0)).result.result.result == FAILED
    call.set_to(SimulationState.STATE_STOPPED)
    assert ended(begun(1)).result.result.result == FAILED
    client.destroy()


def test_worlds_are_loaded_and_unloaded(call: StandardClient) -> None:
    """Scenes and generated rooms; without a world nothing but worlds can be asked for."""
    code = srv.LoadWorld.Response
    worlds = call("GetAvailableWorlds").worlds
    uris = [one.world_resource.uri for one in worlds]
    assert {"sailenv://scene/optical", "sailenv://scene/generated:kitchen:0"} <= set(uris)
    assert len(set(uris)) == len(uris)
    generated = call("GetAvailableWorlds", filter=TagsFilter(tags=["generated"])).worlds
    assert all(one.name.startswith("generated:") for one in generated)
    call("GetAvailableWorlds", FAILED, additional_sources=["https://example.org"])
    answer = call("LoadWorld", **world("solid_benchmark"))
    assert answer.world == call("GetCurrentWorld").world
    assert (answer.world.name, answer.world.description) == ("solid_benchmark", "Solid benchmark")
    assert call.simulation_state == SimulationState.STATE_STOPPED
    call("LoadWorld", NOT_FOUND, **world("no_such_scene"))
    call("LoadWorld", NOT_FOUND, **world("generated:castle:1"))
    call("LoadWorld", code.UNSUPPORTED_FORMAT, **world(uri="https://example.org/x.sdf"))
    call("LoadWorld", code.NO_RESOURCE)
    assert call("GetCurrentWorld").world.name == "solid_benchmark"
    call("UnloadWorld")
    call("UnloadWorld", srv.UnloadWorld.Response.NO_WORLD_LOADED)
    call("GetCurrentWorld", srv.GetCurrentWorld.Response.NO_WORLD_LOADED)
    assert call.simulation_state == SimulationState.STATE_NO_WORLD
    for kind in ("GetEntities", "StepSimulation", "ResetSimulation", "GetNamedPoses"):
        call(kind, STATE)
    call.set_to(SimulationState.STATE_PLAYING, STATE)
    assert call("GetSpawnables").spawnables
    call("LoadWorld", **world(uri="optical"))
    assert "floor" in call.entities()


def test_random_calls_are_answered_as_a_model_says_and_twice_alike(call: StandardClient) -> None:
    """Every code, name and time; the bytes of all answers are those of a second run."""
    first, counts = storm(call, seed=3, calls=200)
    again, _ = storm(call, seed=3, calls=200)
    assert first == again
    assert len(counts) > 18


def test_time_that_runs_by_itself_is_played_and_paused_and_quit() -> None:
    """In realtime mode; quitting is answered, and ends the process with status 0.

    Names may be mapped to others; a name of the simulator's node is not taken for this one's.
    """
    names = ("-r", "__node:=mine", "-r", "get_entities:=/all_entities")
    with (
        NodeProcess("/playing", remaps=names, agent__width=64, agent__height=48) as node,
        Probe("/playing") as probe,
    ):
        call = StandardClient(probe)
        assert "floor" in probe.call(srv.GetEntities, "/all_entities").entities
        known = probe.node.get_node_names_and_namespaces()
        assert {("mine", "/playing"), ("simulation_interfaces", "/playing")} <= set(known)
        assert call.simulation_state == SimulationState.STATE_PLAYING
        call("StepSimulation", FAILED)
        call.set_to(SimulationState.STATE_PAUSED)
        before = call.state("floor").header.stamp
        call("StepSimulation", steps=24)
        assert call.state("floor").header.stamp != before
        call.set_to(SimulationState.STATE_STOPPED)
        assert call.state("floor").header.stamp.nanosec == 0
        call.set_to(SimulationState.STATE_PLAYING)
        call("LoadWorld", NOT_FOUND, **world("no_such_scene"))
        assert call.simulation_state == SimulationState.STATE_PLAYING
        call.set_to(SimulationState.STATE_QUITTING)
        assert node.status() == 0
