"""Services whose messages' fields are not simply the operation's arguments or its result.

``write_…`` makes fields of a request of the arguments, ``read_…`` arguments of the fields;
``fill_…`` writes a result into a response, ``…_of_response`` reads it there.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np

import sailenv_msgs.srv as srv
from sailenv_msgs_py.contact_msgs import contact_to_msg
from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.intrinsics_fields import intrinsics_fields, intrinsics_from_fields
from sailenv_msgs_py.object_msgs import (
    keys_to_json,
    to_json,
)
from sailenv_msgs_py.object_truth_msgs import amodal_mask_to_msgs
from sailenv_msgs_py.services.service import Arguments
from sailenv_msgs_py.space_msgs import (
    points_to_msg,
    reach_to_msg,
)
from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import pose_from_msg, pose_stamped_to_msg, pose_to_msg
from sailenv_ros.authoring.viewpoints import CameraView
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.simulation.operations.argument_checks import pose_of
from sailenv_ros.types.agents import AgentPose
from sailenv_ros.types.contacts import Contact
from sailenv_ros.types.lessons import LessonState
from sailenv_ros.types.picture_settings import NAMES
from sailenv_ros.types.rigs import camera_of
from sailenv_ros.types.scene_info import SceneInfo

_NO_CHANGE, _CLOSED, _OPEN = (
    srv.SetWaypoints.Request.AS_IT_IS,
    srv.SetWaypoints.Request.CLOSED,
    srv.SetWaypoints.Request.OPEN,
)


# -- requests of another form than the arguments ---------------------------------------------


def write_agent(given: Arguments) -> Arguments:
    spec = given["spec"]
    return {
        "agent_info": spec,
        "has_pose": spec.pose is not None,
        "pose": spec.pose,
        "cameras": spec.camera_specs,
    }


def read_agent(given: Arguments) -> Arguments:
    pose, spec = given["pose"] if given["has_pose"] else None, given["agent_info"]
    for camera in given["cameras"]:
        if camera.body != spec.name:
            accepted = f"{spec.name}/<camera>, a camera of this rig"
            raise InvalidRequest("name of the camera", camera.name, accepted)
    cameras = {camera_of(camera.name): camera.as_camera() for camera in given["cameras"]}
    if len(cameras) < len(given["cameras"]):
        names = [camera.name for camera in given["cameras"]]
        raise InvalidRequest("names of the cameras", names, "different from each other")
    return {"spec": replace(spec, pose=pose, cameras=cameras or None)}


def write_seed(given: Arguments) -> Arguments:
    return {"keep_seed": given["seed"] is None, "seed": given["seed"]}


def read_seed(given: Arguments) -> Arguments:
    return {"seed": None if given["keep_seed"] else given["seed"]}


def write_chance(given: Arguments) -> Arguments:
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


def read_chance(given: Arguments) -> Arguments:
    return {
        "seed": None if given["keep_seed"] else given["seed"],
        "index": None if given["next_index"] else given["index"],
        "things": given["document"] or None,
        "record": given["record"] or None,
    }


def fill_chance(response: Any, record: Any, info: SceneInfo) -> None:
    response.chosen = json.dumps(record)


def write_lessons(given: Arguments) -> Arguments:
    return {"document": _as_text("lessons", given["lessons"])}


def fill_lesson(response: Any, state: LessonState | None, info: SceneInfo) -> None:
    response.lesson = "" if state is None else state.to_json()


def lesson_of_response(response: Any) -> LessonState | None:
    return LessonState.from_json(response.lesson) if response.lesson else None


def write_spawned(given: Arguments) -> Arguments:
    static, bodily = given["remove_dynamics"], given["behaviours"] or given["mass_kg"]
    return {
        **given,
        "pose": pose_of(given["position"], given["rotation"], given["pose"]),
        "remove_dynamics": not bodily if static is None else static,
    }


def read_spawned(given: Arguments) -> Arguments:
    # In a message, where numbers are 0 unless they are set, a scale of 0 means 1.
    return given if any(given["scale"]) else {**given, "scale": (1.0, 1.0, 1.0)}


def fill_spawned(response: Any, result: int, info: SceneInfo) -> None:
    response.id = result
    # Unless somebody else has taken it out again already.
    response.spawned_name = next((i.name for i in info.instances if i.id == result), "")


def write_moved(given: Arguments) -> Arguments:
    position, rotation = given["position"], given["rotation"]
    to = {**given, "pose": pose_of(position, rotation, given["pose"])}
    if given["pose"] is not None:
        return to
    return {
        **to,
        "keep_position": position is None,
        "keep_orientation": rotation is None,
    }


def read_moved(given: Arguments) -> Arguments:
    pose = given["pose"]
    keep_position, keep_orientation = given.pop("keep_position"), given.pop("keep_orientation")
    if keep_position or keep_orientation:
        given["pose"] = None
        given["position"] = None if keep_position else pose.position_m
        given["rotation"] = None if keep_orientation else pose.rpy_deg
    return given


def write_picture(given: Arguments) -> Arguments:
    settings, changes = given["settings"], given["changes"]
    whole = {} if settings is None else {name: getattr(settings, name) for name in NAMES}
    return {"changes": {**whole, **changes}}


def write_waypoints(given: Arguments) -> Arguments:
    loop = {None: _NO_CHANGE, True: _CLOSED, False: _OPEN}
    chosen = given["loop"]
    return {**given, "loop": loop[None if chosen is None else bool(chosen)]}


def read_waypoints(given: Arguments) -> Arguments:
    loop = {_NO_CHANGE: None, _CLOSED: True, _OPEN: False}
    if given["loop"] not in loop:
        raise InvalidRequest("loop", given["loop"], "0 (as it is), 1 (closed) or 2 (open)")
    return {**given, "loop": loop[given["loop"]]}


def write_scenario(given: Arguments) -> Arguments:
    scenario = given["scenario"]
    is_text = isinstance(scenario, str)
    return {"scenario": scenario if is_text else keys_to_json("scenario", scenario)}


def write_wrench(given: Arguments) -> Arguments:
    point = given["point_m"]
    return {
        **given,
        "has_point": point is not None,
        "point": (0.0, 0.0, 0.0) if point is None else point,
    }


def read_wrench(given: Arguments) -> Arguments:
    has_point, point, mover = (given.pop(key) for key in ("has_point", "point", "mover"))
    obj = given["obj"]
    if mover and obj:
        raise InvalidRequest("id", obj, "0 beside the name of a mover")
    return {**given, "obj": mover or obj, "point_m": point if has_point else None}


def write_body(given: Arguments) -> Arguments:
    return {**given, "release": given["body"] is None}


def read_body(given: Arguments) -> Arguments:
    return {**given, "body": None} if given.pop("release") else given


def write_look_at(given: Arguments) -> Arguments:
    point = given["point_m"]
    return {
        **given,
        "release": given["obj"] is None and point is None,
        "point_m": (0.0, 0.0, 0.0) if point is None else point,
    }


def read_look_at(given: Arguments) -> Arguments:
    return {**given, "obj": None, "point_m": None} if given.pop("release") else given


def write_background(given: Arguments) -> Arguments:
    return {"sky": given["kind"] == "sky", "keep_colour": given["colour"] is None, **given}


def read_background(given: Arguments) -> Arguments:
    colour = None if given["sky"] or given["keep_colour"] else given["colour"]
    return {"kind": "sky" if given["sky"] else "colour", "colour": colour}


def write_intrinsics(given: Arguments) -> Arguments:
    return intrinsics_fields(given["intrinsics"])


def read_intrinsics(given: Arguments) -> Arguments:
    return {"intrinsics": intrinsics_from_fields(given)}


def write_random_pose(given: Arguments) -> Arguments:
    seed, place = given["seed"], given["reachable_from"]
    return {**given, "keep_seed": seed is None, "anywhere": place is None}


def read_random_pose(given: Arguments) -> Arguments:
    if given.pop("keep_seed"):
        given["seed"] = None
    if given.pop("anywhere"):
        given["reachable_from"] = None
    return given


def read_sampling(given: Arguments) -> Arguments:
    if given.pop("keep_seed"):
        given["seed"] = None
    return given


def write_rays(given: Arguments) -> Arguments:
    return {
        **given,
        "max_distance_m": reach_to_msg(given["max_distance_m"]),
    }


def read_rays(given: Arguments) -> Arguments:
    reach = given["max_distance_m"]
    return {
        **given,
        "max_distance_m": math.inf if reach == 0.0 else reach,
    }


# -- responses of several fields -------------------------------------------------------------


def fill_pose(response: Any, here: AgentPose, info: SceneInfo) -> None:
    stamp = stamp_from_ns(here.sim_time_ns)
    response.pose = pose_stamped_to_msg(here.pose, stamp, WORLD_FRAME_ID)
    response.roll_deg, response.pitch_deg, response.yaw_deg = here.pose.rpy_deg
    response.following = here.following
    response.mover = here.mover


def pose_of_response(response: Any) -> AgentPose:
    return AgentPose(
        pose=pose_from_msg(response.pose.pose),
        following=response.following,
        mover=response.mover,
        sim_time_ns=ns_from_stamp(response.pose.header.stamp),
    )


def fill_frame(response: Any, frame: Frame, info: SceneInfo) -> None:
    response.stamp = stamp_from_ns(frame.stamp_ns)
    response.sequence = frame.sequence


def fill_rig(response: Any, frames: dict[str, Frame], info: SceneInfo) -> None:
    for frame in frames.values():
        response.stamp = stamp_from_ns(frame.stamp_ns)
    response.cameras = [frame.agent for frame in frames.values()]
    response.sequences = [frame.sequence for frame in frames.values()]


def fill_contacts(response: Any, contacts: tuple[Contact, ...], info: SceneInfo) -> None:
    response.contacts = [contact_to_msg(contact) for contact in contacts]


def fill_masks(response: Any, masks: AmodalMasks, info: SceneInfo) -> None:
    response.height, response.width = masks.height, masks.width
    response.masks = amodal_mask_to_msgs(masks)


def fill_path(response: Any, positions: Any, info: SceneInfo) -> None:
    response.positions = points_to_msg(positions)
    response.length_m = float(np.linalg.norm(np.diff(positions, axis=0), axis=1).sum())


def fill_views(response: Any, views: tuple[CameraView, ...], info: SceneInfo) -> None:
    response.poses = [pose_to_msg(view.pose) for view in views]
    response.ids = [view.target_id for view in views]
