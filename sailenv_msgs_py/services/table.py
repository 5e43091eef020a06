"""The service of every operation. Who adds an operation adds its line here.

Only messages whose fields are not simply the operation's arguments need functions, in
`conversions`.
"""

from __future__ import annotations

import json

import sailenv_msgs.srv as srv
from sailenv_msgs_py.contact_msgs import contact_from_msg
from sailenv_msgs_py.joint_msgs import joints_from_response, joints_to_response
from sailenv_msgs_py.object_msgs import (
    object_state_from_response,
    object_state_to_response,
)
from sailenv_msgs_py.object_truth_msgs import amodal_masks_from_msgs
from sailenv_msgs_py.services import conversions as convert
from sailenv_msgs_py.services.robot_services import ROBOT_SERVICES
from sailenv_msgs_py.services.service import Service
from sailenv_msgs_py.space_msgs import (
    free_space_from_response,
    free_space_to_response,
    ray_cast_from_response,
    ray_cast_to_response,
    triples_from_msg,
)
from sailenv_msgs_py.transforms import pose_from_msg
from sailenv_ros.authoring.viewpoints import CameraView
from sailenv_ros.simulation.operations import Operations

__all__ = ["AGENT_SERVICES", "SERVICES", "SIMULATOR_SERVICES"]

SIMULATOR_SERVICES: tuple[Service, ...] = (
    # agents
    Service(
        Operations.register_agent,
        srv.RegisterAgent,
        names={"agent_info": "agent"},
        write=convert.write_agent,
        read=convert.read_agent,
    ),
    Service(Operations.delete_agent, srv.DeleteAgent),
    # scene and time
    Service(Operations.change_scene, srv.ChangeScene),
    Service(Operations.reset, srv.Reset, write=convert.write_seed, read=convert.read_seed),
    Service(
        Operations.randomise,
        srv.Randomise,
        write=convert.write_chance,
        read=convert.read_chance,
        fill=convert.fill_chance,
        result=lambda response: json.loads(response.chosen),
    ),
    Service(
        Operations.start_lessons,
        srv.StartLessons,
        write=convert.write_lessons,
        read=lambda given: {"lessons": given["document"] or None},
        fill=convert.fill_lesson,
        result=convert.lesson_of_response,
    ),
    Service(Operations.stop_lessons, srv.StopLessons),
    Service(
        Operations.get_lesson,
        srv.GetLesson,
        fill=convert.fill_lesson,
        result=convert.lesson_of_response,
    ),
    Service(Operations.step, srv.Step, names={"count": "steps"}),
    Service(Operations.pause, srv.Pause),
    Service(Operations.resume, srv.Resume),
    Service(Operations.set_real_time_factor, srv.SetRealTimeFactor),
    # objects
    Service(
        Operations.spawn_object,
        srv.SpawnObject,
        names={"name": "asset", "object_name": "name", "remove_dynamics": "is_static"},
        write=convert.write_spawned,
        read=convert.read_spawned,
        fill=convert.fill_spawned,
        result=lambda response: response.id,
    ),
    Service(Operations.despawn_object, srv.DespawnObject),
    Service(
        Operations.move_object, srv.MoveObject, write=convert.write_moved, read=convert.read_moved
    ),
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
        write=convert.write_wrench,
        read=convert.read_wrench,
    ),
    Service(
        Operations.contacts,
        srv.GetContacts,
        name="get_contacts",
        fill=convert.fill_contacts,
        result=lambda response: tuple(map(contact_from_msg, response.contacts)),
    ),
    Service(Operations.set_joint_position, srv.SetJointPosition),
    Service(
        Operations.get_joints,
        srv.GetJoints,
        fill=lambda response, joints, info: joints_to_response(response, joints),
        result=joints_from_response,
    ),
    *ROBOT_SERVICES,
    Service(
        Operations.load_scenario,
        srv.LoadScenario,
        names={"scenario": "document"},
        write=convert.write_scenario,
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
        write=convert.write_background,
        read=convert.read_background,
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
    Service(
        Operations.set_mover_body,
        srv.SetMoverBody,
        write=convert.write_body,
        read=convert.read_body,
    ),
    Service(Operations.get_mover_velocity, srv.GetMoverVelocity),
    Service(
        Operations.set_mover_look_at,
        srv.SetMoverLookAt,
        names={"point_m": "point"},
        none={"obj": 0},
        write=convert.write_look_at,
        read=convert.read_look_at,
    ),
    Service(
        Operations.set_waypoints,
        srv.SetWaypoints,
        names={"total_time_s": "total_time"},
        none={"total_time_s": 0.0},
        write=convert.write_waypoints,
        read=convert.read_waypoints,
    ),
    Service(Operations.get_mover_pose, srv.GetMoverPose),
    # space
    Service(Operations.scene_bounds, srv.GetSceneBounds, name="get_scene_bounds"),
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
        fill=convert.fill_path,
        result=lambda response: triples_from_msg(response.positions),
    ),
    Service(
        Operations.random_pose,
        srv.GetRandomPose,
        name="get_random_pose",
        write=convert.write_random_pose,
        read=convert.read_random_pose,
    ),
    Service(
        Operations.cast_rays,
        srv.CastRays,
        write=convert.write_rays,
        read=convert.read_rays,
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
        fill=convert.fill_pose,
        result=convert.pose_of_response,
    ),
    Service(
        Operations.set_look_at,
        srv.SetLookAt,
        names={"point_m": "point"},
        none={"obj": 0},
        write=convert.write_look_at,
        read=convert.read_look_at,
    ),
    Service(Operations.toggle_follow, srv.ToggleFollow),
    Service(Operations.set_follow, srv.SetFollow),
    Service(Operations.set_rate, srv.SetRate),
    Service(
        Operations.set_intrinsics,
        srv.SetIntrinsics,
        write=convert.write_intrinsics,
        read=convert.read_intrinsics,
    ),
    Service(Operations.get_picture, srv.GetPicture),
    Service(Operations.set_picture, srv.SetPicture, write=convert.write_picture),
    Service(
        Operations.sample_cameras,
        srv.SampleCameras,
        write=lambda given: {**given, "keep_seed": given["seed"] is None},
        read=convert.read_sampling,
        fill=convert.fill_views,
        result=lambda response: tuple(
            CameraView(pose=pose_from_msg(pose), target_id=target)
            for pose, target in zip(response.poses, response.ids, strict=True)
        ),
    ),
    Service(Operations.capture, srv.Capture, none={"views": []}, fill=convert.fill_frame),
    Service(Operations.capture_rig, srv.CaptureRig, none={"views": []}, fill=convert.fill_rig),
    Service(
        Operations.get_amodal_masks,
        srv.GetAmodalMasks,
        fill=convert.fill_masks,
        result=lambda response: amodal_masks_from_msgs(
            response.masks, response.height, response.width
        ),
    ),
)
"""Services of each agent."""

SERVICES = {service.operation.name: service for service in (*SIMULATOR_SERVICES, *AGENT_SERVICES)}
"""The service of each operation by the operation's name."""
