"""Rewards and figures of each task, against arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.gym.explore import ExploreEnv
from sailenv_ros.gym.fixate import FixateEnv
from sailenv_ros.gym.open_door import OpenEnv
from sailenv_ros.gym.point_nav import PointNavEnv
from sailenv_ros.gym.rearrange import RearrangeEnv
from sailenv_ros.gym.room_env import RoomEnv
from sailenv_ros.gym.search import SearchEnv
from sailenv_ros.gym.track import TrackEnv
from sailenv_ros.gym.walker import Walker
from sailenv_ros.space.free_space import BodySize, FreeSpace

Make = Callable[..., RoomEnv]


def corridor(length: int = 40) -> FreeSpace:
    """A corridor of 0.1 m cells along x, 5 cells wide, with a wall around."""
    cells = np.full((7, length), 100, np.int8)
    cells[1:-1, 1:-1] = 0
    body = BodySize(height_m=1.0, radius_m=0.1, resolution_m=0.1)
    return FreeSpace(cells=cells, origin_m=(0.0, 0.0), body=body)


# -- walking -------------------------------------------------------------------------------------


def test_a_walker_goes_where_it_is_free() -> None:
    walker = Walker(0.55, 0.35, 0.0, 1.0)
    assert not walker.walk(corridor(), 1.0)
    assert (walker.x_m, walker.y_m) == pytest.approx((1.55, 0.35))
    walker.turn(90.0)
    assert not walker.walk(corridor(), -0.2)
    assert (walker.x_m, walker.y_m) == pytest.approx((1.55, 0.15))
    assert walker.walked_m == pytest.approx(1.2)
    assert not walker.bumps


def test_a_walker_stops_at_a_wall() -> None:
    walker = Walker(0.55, 0.35, 90.0, 1.0)
    assert walker.walk(corridor(), 1.0)
    assert walker.bumps == 1
    assert corridor().is_free((walker.x_m, walker.y_m))
    assert 0.55 <= walker.y_m <= 0.6
    assert walker.walked_m == pytest.approx(walker.y_m - 0.35)


def test_a_walker_does_not_slip_between_cells_that_touch_at_a_corner() -> None:
    open_ = corridor(20)
    cells = open_.cells.copy()
    cells[1:3, 10:] = cells[3:, :10] = 100  # free are 1:3, :10 and 3:6, 10:
    space = FreeSpace(cells=cells, origin_m=(0.0, 0.0), body=open_.body)
    walker = Walker(0.85, 0.15, 45.0, 1.0)
    assert walker.walk(space, 0.5)
    assert space.regions[space.cell_of((walker.x_m, walker.y_m)) or (0, 0)] == 2


def test_a_walker_cannot_leave_the_map() -> None:
    open_ = corridor()
    free = FreeSpace(cells=np.zeros_like(open_.cells), origin_m=(0.0, 0.0), body=open_.body)
    walker = Walker(0.55, 0.35, 180.0, 1.0)
    assert walker.walk(free, 5.0)
    assert 0.0 <= walker.x_m < 0.1


# -- Track ---------------------------------------------------------------------------------------


def test_the_reward_of_tracking_is_the_angle_to_the_object(make: Make) -> None:
    env = make("Track", discrete=False)
    assert isinstance(env, TrackEnv)
    _, info = env.reset(seed=2)
    for number in range(60):
        offset = env._target[:3, 3] - np.array(env._eye_pose().position_m)
        ahead = env._eye_pose().matrix()[:3, 0]
        error_deg = math.degrees(math.acos(offset @ ahead / np.linalg.norm(offset)))
        assert info["angle_error_deg"] == pytest.approx(error_deg, abs=1e-5)
        wish = np.clip(np.array([-1.0, 1.0]) * math.sin(number), -1, 1).astype(np.float32)
        _, reward, _, _, info = env.step(wish)
        assert reward == pytest.approx(max(-1.0, 1.0 - info["angle_error_deg"] / 37.5))


def test_who_knows_where_the_object_is_keeps_it_centred(make: Make) -> None:
    env = make("Track", discrete=False, views=("instance", "depth"), width=201, height=201)
    assert isinstance(env, TrackEnv)
    env.reset(seed=0)
    target = env.room.ids[env.room.rows["target"]]
    labels = []
    for _ in range(100):
        pose = env._eye_pose()
        x, y, z = pose.matrix()[:3, :3].T @ (env._target[:3, 3] - np.array(pose.position_m))
        turn_deg = np.degrees([math.atan2(y, x), math.atan2(-z, math.hypot(x, y))])
        observation, *_, info = env.step(np.clip(turn_deg / 4.0, -1.0, 1.0).astype(np.float32))
        away_m = math.dist(env._target[:3, 3], pose.position_m)
        # Nothing stands before its middle.
        if info["angle_error_deg"] < 1.0 and observation["depth"][100, 100] > away_m - 0.2:
            labels.append(observation["instance"][100, 100])
    assert labels.count(target) == len(labels) > 20
    assert info["success"]
    assert info["centred_share"] > 0.8


def test_the_object_of_tracking_keeps_its_speed(make: Make) -> None:
    env = make("Track", speed_m_s=0.9)
    assert isinstance(env, TrackEnv)
    env.reset(seed=0)
    places = [env._target[:3, 3].copy()]
    for _ in range(90):
        env.step(0)
        places.append(env._target[:3, 3].copy())
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert lengths.max() == pytest.approx(0.03, rel=1e-6)  # 0.9 m/s for 1/30 s
    assert np.median(lengths) == pytest.approx(0.03, rel=1e-6)
    assert {env.room.space.is_free(place) for place in places} == {True}


# -- PointNav ------------------------------------------------------------------------------------


def follow(env: PointNavEnv | SearchEnv, goal: tuple[float, float, float]) -> None:
    """Walk along the shortest path, corner by corner, with continuous actions."""
    walker, space = env._walker, env.room.space
    spare = len(env.action_space.shape or ()) and env.action_space.shape[0] - 2
    for x, y, _ in space.path((walker.x_m, walker.y_m), goal)[1:]:
        while math.hypot(x - walker.x_m, y - walker.y_m) > 0.02:
            way = math.degrees(math.atan2(y - walker.y_m, x - walker.x_m))
            left = math.remainder(way - walker.yaw_deg, 360.0) / env._turn_deg
            far = math.hypot(x - walker.x_m, y - walker.y_m) / env._stride_m
            ahead = 0.0 if abs(left) > 1.0 else min(1.0, far)
            action = np.array([ahead, np.clip(left, -1, 1), *[0.0] * spare], np.float32)
            env.step(action)


def test_the_shortest_path_has_an_spl_of_nearly_one(make: Make) -> None:
    env = make("PointNav", discrete=False)
    assert isinstance(env, PointNavEnv)
    _, info = env.reset(seed=3)
    begun_m = info["distance_to_goal_m"]
    follow(env, env._goal)
    observation, reward, over, _, info = env.step(np.array([0, 0, 1], np.float32))
    assert over
    assert info["success"]
    assert info["spl"] > 0.95
    assert info["path_length_m"] == pytest.approx(info["shortest_path_m"], rel=0.05)
    assert info["distance_to_goal_m"] <= 0.1 < begun_m
    assert reward == pytest.approx(10.0 - 0.01)
    assert observation["goal"][0] < 0.1


def test_rewards_of_walking_add_up_to_the_distance_gained(make: Make) -> None:
    env = make("PointNav")
    _, before = env.reset(seed=1)
    total = 0.0
    for action in (1, 1, 2, 1, 1, 3, 3, 1):
        _, reward, _, _, info = env.step(action)
        total += reward
    gained = before["distance_to_goal_m"] - info["distance_to_goal_m"]
    assert total == pytest.approx(gained - 8 * 0.01)


def test_to_stop_far_from_the_goal_is_no_success(make: Make) -> None:
    env = make("PointNav")
    env.reset(seed=0)
    _, reward, over, _, info = env.step(0)
    assert over
    assert not info["success"]
    assert info["spl"] == 0.0
    assert reward == pytest.approx(-0.01)


def test_the_goal_is_told_from_where_the_agent_stands(make: Make) -> None:
    env = make("PointNav")
    assert isinstance(env, PointNavEnv)
    observation, _ = env.reset(seed=5)
    distance, direction = observation["goal"].tolist()
    ahead = env._walker.yaw_deg + math.degrees(direction)
    there = (
        env._walker.x_m + distance * math.cos(math.radians(ahead)),
        env._walker.y_m + distance * math.sin(math.radians(ahead)),
    )
    assert there == pytest.approx(env._goal[:2], abs=1e-5)


# -- Search --------------------------------------------------------------------------------------


def test_an_object_is_found_near_it_and_with_it_in_view(make: Make) -> None:
    env = make("Search", categories=["couch"], discrete=False, views=("category",))
    assert isinstance(env, SearchEnv)
    observation, info = env.reset(seed=0)
    assert info["category"] == "couch"
    assert observation["goal"] == env.room.snapshot.contents.categories.named("couch").id
    assert info["distance_to_goal_m"] > 0.0
    # To the nearest place from which it counts, then turned to the object.
    space = env.room.space
    cells = np.argwhere(env._navigation.distances_m == 0.0)
    here = np.array([env._walker.x_m, env._walker.y_m])
    places = [space.position_of(row, column) for row, column in cells.tolist()]
    goal = min(places, key=lambda place: math.dist(here, place[:2]))
    follow(env, goal)
    walker = env._walker
    left = math.remainder(
        math.degrees(math.atan2(0.6 - walker.y_m, 1.0 - walker.x_m)) - walker.yaw_deg, 360.0
    )
    for _ in range(12):
        step = float(np.clip(left / 30.0, -1, 1))
        observation, *_, info = env.step(np.array([0, step, 0.05, 0], np.float32))
        left -= 30.0 * step
    _, reward, over, _, info = env.step(np.array([0, 0, 0, 1], np.float32))
    assert info["goal_pixels"] == np.count_nonzero(observation["category"] == observation["goal"])
    assert over
    assert info["success"]
    assert info["spl"] > 0.8
    assert reward == pytest.approx(9.99)


def test_an_object_that_is_only_near_is_not_found(make: Make) -> None:
    env = make("Search", categories=["couch"], seen_share=1.0)
    env.reset(seed=0)
    *_, info = env.step(0)
    assert not info["success"]


def test_parts_of_the_room_are_not_sought(make: Make, tmp_path: Path) -> None:
    """Not even its skirting, which is a category like others."""
    scene = tmp_path / "skirted.yaml"
    objects = "[{name: chair, asset: cube, category: chair, scale: 0.4, position: [0, 0, 0.2]}]"
    scene.write_text(
        f"version: 1\nroom: {{size: [4, 3, 2.4], skirting: {{height: 0.1}}}}\nobjects: {objects}\n"
    )
    env = make("Search", rooms=[str(scene)])
    env.reset(seed=0)
    assert "skirting" in {one.instance.category for one in env.room.snapshot.contents.instances}
    assert list(env.room.objects) == ["chair"]


def test_categories_that_cannot_be_found_are_refused(make: Make) -> None:
    with pytest.raises(UnknownName, match="unicorn"):
        make("Search", categories=["unicorn"])
    with pytest.raises(InvalidRequest, match="list"):
        make("Search", categories="bed")
    with pytest.raises(InvalidRequest, match="toilet"):
        make("Search", categories=["toilet"]).reset(seed=0)


# -- Open ----------------------------------------------------------------------------------------


def before_the_door(make: Make) -> OpenEnv:
    env = make("Open", views=("instance",), reach_m=1.2)
    assert isinstance(env, OpenEnv)
    env.reset(seed=0)
    walker = env._walker
    walker.x_m, walker.y_m, walker.yaw_deg = 1.15, -1.0, 0.0
    env.step(1), env.step(2)  # to look
    return env


def test_a_door_opens_in_equal_steps_about_its_hinge(make: Make) -> None:
    env = before_the_door(make)
    assert env._info()["reached"]
    total = 0.0
    for number in range(1, 9):
        _, reward, over, _, info = env.step(3)
        assert info["open_share"] == number / 8
        total += reward
        # The hinge is at (2.2, -0.8); the leaf's middle is 0.4 m from it.
        pose = env._places()[env._door.leaf]
        angle = -1.6 * number / 8
        middle = (2.2 + 0.4 * math.sin(angle), -0.8 - 0.4 * math.cos(angle))
        assert pose[:2, 3] == pytest.approx(middle, abs=1e-6)
        if not info["reached"] and not over:
            offset = pose[:2, 3] - (env._walker.x_m, env._walker.y_m)
            env._walker.yaw_deg = math.degrees(math.atan2(offset[1], offset[0]))
            total += env.step(1)[1] + env.step(2)[1]
    assert over
    assert info["success"]
    assert total == pytest.approx(1.0 + 10.0 - 0.01 * env._steps + 0.02)


def test_a_door_does_not_turn_against_the_agent(make: Make) -> None:
    env = before_the_door(make)
    env._walker.x_m, env._walker.y_m = 1.9, -1.2
    for _ in range(3):
        *_, info = env.step(3)
    assert info["stuck"] > 0
    assert info["open_share"] < 3 / 8


def test_a_door_out_of_reach_does_not_move(make: Make) -> None:
    env = before_the_door(make)
    env._walker.x_m = 0.8
    env.step(1), env.step(2)
    *_, info = env.step(3)
    assert not info["reached"]
    assert info["open_share"] == 0.0


# -- Explore, Fixate, Rearrange ------------------------------------------------------------------


def test_the_floor_seen_is_what_rays_meet(make: Make) -> None:
    env = make("Explore", width=40, height=30)
    assert isinstance(env, ExploreEnv)
    _, info = env.reset(seed=1)
    space, camera = env.room.space, env._past.camera
    world, seen = camera.world_from_camera, set()
    rays = camera.intrinsics.rays().reshape(-1, 3) @ world[:3, :3].T
    eye = world[:3, 3]
    blocks = [env.room.boxes[env.room.rows[name]] for name in ("box", "cot", "bench", "flap")]
    for ray in rays:
        if ray[2] >= 0.0:
            continue
        ground = eye + ray * (-eye[2] / ray[2])
        cell = space.cell_of(ground)
        if cell is None or space.regions[cell] != 1:
            continue
        # Whether a box is in between: by slabs.
        hit = False
        for low, high in blocks:
            ends = np.stack([(low - eye) / ray, (high - eye) / ray])
            first, last = ends.min(axis=0).max(), ends.max(axis=0).min()
            hit = hit or 0.0 < first < min(last, -eye[2] / ray[2])
        if not hit:
            seen.add(cell)
    marked = {tuple(cell) for cell in np.argwhere(env._seen).tolist()}
    # Rays that graze edges, or the ball, may differ.
    assert len(seen ^ marked) <= 0.03 * len(seen)
    assert info["coverage"] == len(marked) / (space.regions == 1).sum()


def test_exploring_is_rewarded_by_the_area_seen(make: Make) -> None:
    env = make("Explore")
    _, before = env.reset(seed=0)
    total = 0.0
    for _ in range(14):
        _, reward, over, _, info = env.step(1)
        total += reward
        assert over == info["success"] == (info["coverage"] >= 0.95)
        if over:
            break
    assert total == pytest.approx(info["seen_m2"] - before["seen_m2"])
    assert info["coverage"] > before["coverage"]
    assert info["objects_seen"] <= info["objects"]


def face(env: FixateEnv | RearrangeEnv, point: np.ndarray) -> None:
    """Turn the eye towards a point."""
    offset = point - np.array(env._eye_pose().position_m)
    env._eye.yaw_deg = math.degrees(math.atan2(offset[1], offset[0]))
    env._eye.pitch_deg = math.degrees(-math.atan2(offset[2], math.hypot(*offset[:2])))


def test_each_object_is_rewarded_once(make: Make) -> None:
    env = make("Fixate", discrete=False, goal_objects=2, views=("rgb",))
    assert isinstance(env, FixateEnv)
    observation, info = env.reset(seed=0)
    assert observation["rgb"].shape == (20, 32, 3)
    env._eye.x_m, env._eye.y_m = 0.0, -1.5
    rewards, over = [], False
    for name in ("box", "box", "cot"):
        low, high = env.room.boxes[env.room.rows[name]]
        face(env, 0.5 * (low + high))
        observation, reward, over, _, info = env.step(np.zeros(2, np.float32))
        assert info["instance"] == env.room.ids[env.room.rows[name]]
        assert info["category"] == ("couch" if name == "box" else "bed")
        assert env.room.snapshot.contents.categories[int(observation["label"])].name in (
            info["category"],
        )
        rewards.append(reward)
    started = info["fixated"] - sum(reward > 0 for reward in rewards)
    assert rewards[1] == pytest.approx(-0.01)
    assert sum(rewards) == pytest.approx(2 - started - 0.03)
    assert over


def test_what_has_moved_is_told_by_pointing(make: Make) -> None:
    env = make("Rearrange", look_steps=3, width=201, height=151)
    assert isinstance(env, RearrangeEnv)
    env.reset(seed=0)
    (thing,) = env._goals
    still = env.room.scene_at(0, env._places()).world_from_body[thing].copy()
    assert env.step(4)[1] == 0.0  # nothing has moved yet
    env.step(0), env.step(0)
    assert env._phase == 1
    moved = env.room.scene_at(0, env._places()).world_from_body[thing]
    assert 0.2 <= np.linalg.norm(moved[:2, 3] - still[:2, 3]) <= 1.2
    assert moved[2, 3] == still[2, 3]
    env._eye.pitch_deg = 60.0
    _, reward, over, _, info = env.step(4)
    assert (reward, over, info["wrong"]) == (-0.5, False, 1)
    face(env, moved[:3, 3])
    _, reward, over, _, info = env.step(4)
    assert (reward, over, info["found"]) == (1.0, True, 1)
