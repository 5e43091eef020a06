"""The service of every operation. Who adds an operation adds its line here.

Only messages whose fields are not simply the operation's arguments need functions.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np

import sailenv_msgs.srv as srv
from sailenv_msgs_py.contact_msgs import contact_from_msg, contact_to_msg
from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.joint_msgs import joints_from_response, joints_to_response
from sailenv_msgs_py.object_msgs import (
    keys_to_json,
    object_state_from_response,
    object_state_to_response,
    to_json,
)
from sailenv_msgs_py.object_truth_msgs import amodal_mask_to_msgs, amodal_masks_from_msgs
from sailenv_msgs_py.services.service import Arguments, Service
from sailenv_msgs_py.space_msgs import (
    free_space_from_response,
    free_space_to_response,
    points_to_msg,
    ray_cast_from_response,
    ray_cast_to_response,
    reach_to_msg,
    triples_from_msg,
)
from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import pose_from_msg, pose_stamped_to_msg, pose_to_msg
from sailenv_ros.authoring.viewpoints import CameraView
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.simulation.operations.argument_checks import pose_of
from sailenv_ros.types.agents import AgentPose
from sailenv_ros.types.camera import INTRINSICS_LIMITS, CameraIntrinsics
from sailenv_ros.types.contacts import Contact
from sailenv_ros.types.lessons import LessonState
from sailenv_ros.types.picture_settings import NAMES
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["AGENT_SERVICES", "SERVICES", "SIMULATOR_SERVICES"]

_NO_CHANGE, _CLOSED, _OPEN = (
    srv.SetWaypoints.Request.AS_IT_IS,
    srv.SetWaypoints.Request.CLOSED,
    srv.SetWaypoints.Request.OPEN,
)


# -- requests of another form than the arguments ---------------------------------------------


def _write_agent(given: Arguments) -> Arguments:
    spec = given["spec"]
    return {"agent_info": spec, "has_pose": spec.pose is not None, "pose": spec.pose}


def _read_agent(given: Arguments) -> Arguments:
    pose = given["pose"] if given["has_pose"] else None
    return {"spec": replace(given["agent_info"], pose=pose)}


def _write_seed(given: Arguments) -> Arguments:
    return {"keep_seed": given["seed"] is None, "seed": given["seed"]}


def _read_seed(given: Arguments) -> Arguments:
    return {"seed": None if given["keep_seed"] else given["seed"]}


def _write_chance(given: Arguments) -> Arguments:
    return {
        "keep_seed": given["seed"] is None,
        "seed": given["seed"],
        "next_index": given["index"] is None,
        "index": given["index"],
        "document": _as_text("things", given["things"]),
        "record": _as_text("record", given["record"]),
    }


def _as_text(what: str, value: Any) -> str | None:
    return value if value is None or isinstance(value, str) else to_json(what, value)


def _read_chance(given: Arguments) -> Arguments:
    return {
        "seed": None if given["keep_seed"] else given["seed"],
        "index": None if given["next_index"] else given["index"],
        "things": given["document"] or None,
        "record": given["record"] or None,
    }


def _fill_chance(response: Any, record: Any, info: SceneInfo) -> None:
    response.chosen = json.dumps(record)


def _write_lessons(given: Arguments) -> Arguments:
    return {"document": _as_text("lessons", given["lessons"])}


def _fill_lesson(response: Any, state: LessonState | None, info: SceneInfo) -> None:
    response.lesson = "" if state is None else state.to_json()


def _lesson_of_response(response: Any) -> LessonState | None:
    return LessonState.from_json(response.lesson) if response.lesson else None


def _write_spawned(given: Arguments) -> Arguments:
    static, bodily = given["remove_dynamics"], given["behaviours"] or given["mass_kg"]
    return {
        **given,
        "pose": pose_of(given["position"], given["rotation"], given["pose"]),
        "remove_dynamics": not bodily if static is None else static,
    }


def _read_spawned(given: Arguments) -> Arguments:
    # In a message, where numbers are 0 unless they are set, a scale of 0 means 1.
    return given if any(given["scale"]) else {**given, "scale": (1.0, 1.0, 1.0)}


def _fill_spawned(response: Any, result: int, info: SceneInfo) -> None:
    response.id = result
    # Unless somebody else has taken it out again already.
    response.spawned_name = next((i.name for i in info.instances if i.id == result), "")


def _write_moved(given: Arguments) -> Arguments:
    if given["pose"] is not None:
        return given
    position, rotation = given["position"], given["rotation"]
    return {
        **given,
        "pose": pose_of(
            (0.0, 0.0, 0.0) if position is None else position,
            (0.0, 0.0, 0.0) if rotation is None else rotation,
            None,
        ),
        "keep_position": position is None,
        "keep_orientation": rotation is None,
    }


def _read_moved(given: Arguments) -> Arguments:
    pose = given["pose"]
    keep_position, keep_orientation = given.pop("keep_position"), given.pop("keep_orientation")
    if keep_position or keep_orientation:
        given["pose"] = None
        given["position"] = None if keep_position else pose.position_m
        given["rotation"] = None if keep_orientation else pose.rpy_deg
    return given


def _write_picture(given: Arguments) -> Arguments:
    settings, changes = given["settings"], given["changes"]
    whole = {} if settings is None else {name: getattr(settings, name) for name in NAMES}
    return {"changes": {**whole, **changes}}


def _write_waypoints(given: Arguments) -> Arguments:
    loop = {None: _NO_CHANGE, True: _CLOSED, False: _OPEN}
    chosen = given["loop"]
    return {**given, "loop": loop[None if chosen is None else bool(chosen)]}


def _read_waypoints(given: Arguments) -> Arguments:
    loop = {_NO_CHANGE: None, _CLOSED: True, _OPEN: False}
    if given["loop"] not in loop:
        raise InvalidRequest("loop", given["loop"], "0 (as it is), 1 (closed) or 2 (open)")
    return {**given, "loop": loop[given["loop"]]}


def _write_scenario(given: Arguments) -> Arguments:
    scenario = given["scenario"]
    is_text = isinstance(scenario, str)
    return {"scenario": scenario if is_text else keys_to_json("scenario", scenario)}


def _write_wrench(given: Arguments) -> Arguments:
    point = given["point_m"]
    return {
        **given,
        "has_point": point is not None,
        "point": (0.0, 0.0, 0.0) if point is None else point,
    }


def _read_wrench(given: Arguments) -> Arguments:
    has_point, point, mover = (given.pop(key) for key in ("has_point", "point", "mover"))
    obj = given["obj"]
    if mover and obj:
        raise InvalidRequest("id", obj, "0 beside the name of a mover")
    return {**given, "obj": mover or obj, "point_m": point if has_point else None}


def _write_body(given: Arguments) -> Arguments:
    return {**given, "release": given["body"] is None}


def _read_body(given: Arguments) -> Arguments:
    return {**given, "body": None} if given.pop("release") else given


def _write_look_at(given: Arguments) -> Arguments:
    point = given["point_m"]
    return {
        **given,
        "release": given["obj"] is None and point is None,
        "point_m": (0.0, 0.0, 0.0) if point is None else point,
    }


def _read_look_at(given: Arguments) -> Arguments:
    return {**given, "obj": None, "point_m": None} if given.pop("release") else given


def _write_background(given: Arguments) -> Arguments:
    return {"sky": given["kind"] == "sky", "keep_colour": given["colour"] is None, **given}


def _read_background(given: Arguments) -> Arguments:
    colour = None if given["sky"] or given["keep_colour"] else given["colour"]
    return {"kind": "sky" if given["sky"] else "colour", "colour": colour}


def _write_intrinsics(given: Arguments) -> Arguments:
    camera: CameraIntrinsics = given["intrinsics"]
    return dict(camera.numbers())


def _read_intrinsics(given: Arguments) -> Arguments:
    return {"intrinsics": CameraIntrinsics(**{name: given[name] for name in INTRINSICS_LIMITS})}


def _write_random_pose(given: Arguments) -> Arguments:
    seed, place = given["seed"], given["reachable_from"]
    return {**given, "keep_seed": seed is None, "anywhere": place is None}


def _read_random_pose(given: Arguments) -> Arguments:
    if given.pop("keep_seed"):
        given["seed"] = None
    if given.pop("anywhere"):
        given["reachable_from"] = None
    return given


def _read_sampling(given: Arguments) -> Arguments:
    if given.pop("keep_seed"):
        given["seed"] = None
    return given


def _write_rays(given: Arguments) -> Arguments:
    return {
        **given,
        "max_distance_m": reach_to_msg(given["max_distance_m"]),
    }


def _read_rays(given: Arguments) -> Arguments:
    reach = given["max_distance_m"]
    return {
        **given,
        "max_distance_m": math.inf if reach == 0.0 else reach,
    }


# -- responses of several fields -------------------------------------------------------------


def _fill_pose(response: Any, here: AgentPose, info: SceneInfo) -> None:
    stamp = stamp_from_ns(here.sim_time_ns)
    response.pose = pose_stamped_to_msg(here.pose, stamp, WORLD_FRAME_ID)
    response.roll_deg, response.pitch_deg, response.yaw_deg = here.pose.rpy_deg
    response.following = here.following
    response.mover = here.mover


def _pose_of_response(response: Any) -> AgentPose:
    return AgentPose(
        pose=pose_from_msg(response.pose.pose),
        following=response.following,
        mover=response.mover,
        sim_time_ns=ns_from_stamp(response.pose.header.stamp),
    )


def _fill_frame(response: Any, frame: Frame, info: SceneInfo) -> None:
    response.stamp = stamp_from_ns(frame.stamp_ns)
    response.sequence = frame.sequence


def _fill_contacts(response: Any, contacts: tuple[Contact, ...], info: SceneInfo) -> None:
    response.contacts = [contact_to_msg(contact) for contact in contacts]


def _fill_masks(response: Any, masks: AmodalMasks, info: SceneInfo) -> None:
    response.height, response.width = masks.height, masks.width
    response.masks = amodal_mask_to_msgs(masks)


def _fill_path(response: Any, positions: Any, info: SceneInfo) -> None:
    response.positions = points_to_msg(positions)
    response.length_m = float(np.linalg.norm(np.diff(positions, axis=0), axis=1).sum())


def _fill_views(response: Any, views: tuple[CameraView, ...], info: SceneInfo) -> None:
    response.poses = [pose_to_msg(view.pose) for view in views]
    response.ids = [view.target_id for view in views]


SIMULATOR_SERVICES: tuple[Service, ...] = (
    # agents
    Service(
        Operations.register_agent,
        srv.RegisterAgent,
        names={"agent_info": "agent"},
        write=_write_agent,
        read=_read_agent,
    ),
    Service(Operations.delete_agent, srv.DeleteAgent),
    # scene and time
    Service(Operations.change_scene, srv.ChangeScene),
    Service(Operations.reset, srv.Reset, write=_write_seed, read=_read_seed),
    Service(
        Operations.randomise,
        srv.Randomise,
        write=_write_chance,
        read=_read_chance,
        fill=_fill_chance,
        result=lambda response: json.loads(response.chosen),
    ),
    Service(
        Operations.start_lessons,
        srv.StartLessons,
        write=_write_lessons,
        read=lambda given: {"lessons": given["document"] or None},
        fill=_fill_lesson,
        result=_lesson_of_response,
    ),
    Service(Operations.stop_lessons, srv.StopLessons),
    Service(Operations.get_lesson, srv.GetLesson, fill=_fill_lesson, result=_lesson_of_response),
    Service(Operations.step, srv.Step, names={"count": "steps"}),
    Service(Operations.pause, srv.Pause),
    Service(Operations.resume, srv.Resume),
    Service(Operations.set_real_time_factor, srv.SetRealTimeFactor),
    # objects
    Service(
        Operations.spawn_object,
        srv.SpawnObject,
        names={"name": "asset", "object_name": "name", "remove_dynamics": "is_static"},
        write=_write_spawned,
        read=_read_spawned,
        fill=_fill_spawned,
        result=lambda response: response.id,
    ),
    Service(Operations.despawn_object, srv.DespawnObject),
    Service(Operations.move_object, srv.MoveObject, write=_write_moved, read=_read_moved),
    Service(Operations.change_object, srv.ChangeObject),
    Service(Operations.set_material, srv.SetMaterial),
    Service(Operations.upload_picture, srv.UploadPicture),
    Service(
        Operations.get_object,
        srv.GetObject,
        fill=lambda response, state, info: object_state_to_response(state, response),
        result=object_state_from_response,
    ),
    Service(Operations.add_behaviour, srv.AddBehaviour),
    Service(Operations.remove_behaviours, srv.RemoveBehaviours),
    Service(
        Operations.apply_wrench,
        srv.ApplyWrench,
        write=_write_wrench,
        read=_read_wrench,
    ),
    Service(
        Operations.contacts,
        srv.GetContacts,
        name="get_contacts",
        fill=_fill_contacts,
        result=lambda response: tuple(map(contact_from_msg, response.contacts)),
    ),
    Service(Operations.set_joint_position, srv.SetJointPosition),
    Service(
        Operations.get_joints,
        srv.GetJoints,
        fill=lambda response, joints, info: joints_to_response(response, joints),
        result=joints_from_response,
    ),
    Service(
        Operations.load_scenario,
        srv.LoadScenario,
        names={"scenario": "document"},
        write=_write_scenario,
        result=lambda response: tuple(response.ids),
    ),
    Service(
        Operations.spawnable_display_names,
        srv.GetDisplayNames,
        result=lambda response: tuple(response.names),
    ),
    # lights and surroundings
    Service(Operations.get_light, srv.GetLight, names={"light_name": "name"}),
    Service(Operations.set_light, srv.SetLight, names={"light_name": "name"}),
    Service(Operations.add_light, srv.AddLight, names={"light_name": "name", "light_type": "type"}),
    Service(Operations.remove_light, srv.RemoveLight, names={"light_name": "name"}),
    Service(Operations.get_ambient_light, srv.GetAmbientLight),
    Service(Operations.set_ambient_light, srv.SetAmbientLight),
    Service(
        Operations.set_background,
        srv.SetBackground,
        write=_write_background,
        read=_read_background,
    ),
    Service(Operations.set_environment, srv.SetEnvironment),
    Service(Operations.get_gravity, srv.GetGravity),
    Service(Operations.set_gravity, srv.SetGravity),
    # movers
    Service(Operations.set_mover_controller, srv.SetMoverController),
    Service(
        Operations.drive_mover,
        srv.DriveMover,
        write=lambda given: {**given, "command": (given["linear_m_s"], given["angular_rad_s"])},
        read=lambda given: {
            "linear_m_s": given["command"][0],
            "angular_rad_s": given["command"][1],
            "mover": given["mover"],
        },
    ),
    Service(Operations.turn_mover, srv.TurnMover),
    Service(Operations.set_mover_body, srv.SetMoverBody, write=_write_body, read=_read_body),
    Service(Operations.get_mover_velocity, srv.GetMoverVelocity),
    Service(
        Operations.set_mover_look_at,
        srv.SetMoverLookAt,
        names={"point_m": "point"},
        none={"obj": 0},
        write=_write_look_at,
        read=_read_look_at,
    ),
    Service(
        Operations.set_waypoints,
        srv.SetWaypoints,
        names={"total_time_s": "total_time"},
        none={"total_time_s": 0.0},
        write=_write_waypoints,
        read=_read_waypoints,
    ),
    Service(Operations.get_mover_pose, srv.GetMoverPose),
    # space
    Service(
        Operations.free_space,
        srv.GetFreeSpace,
        name="get_free_space",
        fill=lambda response, space, info: free_space_to_response(response, space),
        result=free_space_from_response,
    ),
    Service(
        Operations.find_path,
        srv.FindPath,
        fill=_fill_path,
        result=lambda response: triples_from_msg(response.positions),
    ),
    Service(
        Operations.random_pose,
        srv.GetRandomPose,
        name="get_random_pose",
        write=_write_random_pose,
        read=_read_random_pose,
    ),
    Service(
        Operations.cast_rays,
        srv.CastRays,
        write=_write_rays,
        read=_read_rays,
        fill=lambda response, cast, info: ray_cast_to_response(response, cast),
        result=ray_cast_from_response,
    ),
    # saving and models
    Service(Operations.scene_text, srv.GetSceneText, name="get_scene_text", none={"title": ""}),
    Service(Operations.save_scene, srv.SaveScene, none={"title": ""}),
    Service(Operations.upload_model, srv.UploadModel),
    Service(Operations.get_thumbnail_png, srv.GetThumbnail, name="get_thumbnail"),
)
"""Services of the simulator."""

AGENT_SERVICES: tuple[Service, ...] = (
    Service(Operations.set_position, srv.SetPosition),
    Service(
        Operations.set_rotation,
        srv.SetRotation,
        write=lambda given: {
            **dict(zip(("roll_deg", "pitch_deg", "yaw_deg"), given["rotation"], strict=True)),
            "teleport": given["teleport"],
        },
        read=lambda given: {
            "rotation": tuple(given[name] for name in ("roll_deg", "pitch_deg", "yaw_deg")),
            "teleport": given["teleport"],
        },
    ),
    Service(Operations.set_pose, srv.SetPose),
    Service(
        Operations.get_agent_pose,
        srv.GetPose,
        name="get_pose",
        fill=_fill_pose,
        result=_pose_of_response,
    ),
    Service(
        Operations.set_look_at,
        srv.SetLookAt,
        names={"point_m": "point"},
        none={"obj": 0},
        write=_write_look_at,
        read=_read_look_at,
    ),
    Service(Operations.toggle_follow, srv.ToggleFollow),
    Service(Operations.set_follow, srv.SetFollow),
    Service(Operations.set_rate, srv.SetRate),
    Service(
        Operations.set_intrinsics,
        srv.SetIntrinsics,
        write=_write_intrinsics,
        read=_read_intrinsics,
    ),
    Service(Operations.get_picture, srv.GetPicture),
    Service(Operations.set_picture, srv.SetPicture, write=_write_picture),
    Service(
        Operations.sample_cameras,
        srv.SampleCameras,
        write=lambda given: {**given, "keep_seed": given["seed"] is None},
        read=_read_sampling,
        fill=_fill_views,
        result=lambda response: tuple(
            CameraView(pose=pose_from_msg(pose), target_id=target)
            for pose, target in zip(response.poses, response.ids, strict=True)
        ),
    ),
    Service(Operations.capture, srv.Capture, none={"views": []}, fill=_fill_frame),
    Service(
        Operations.get_amodal_masks,
        srv.GetAmodalMasks,
        fill=_fill_masks,
        result=lambda response: amodal_masks_from_msgs(
            response.masks, response.height, response.width
        ),
    ),
)
"""Services of each agent."""

SERVICES = {service.operation.name: service for service in (*SIMULATOR_SERVICES, *AGENT_SERVICES)}
"""The service of each operation by the operation's name."""
