"""`/tf` and `/tf_static`: world → agent → camera → optical frame.

Of a rig: world → agent → each of its cameras → optical frame.

On request also world → object, for every instance.

Frames and agents' names in, transforms out. Names of frames are `<agent>/…_frame`; an optical frame
has `optical` in it (REP 103).
"""

from __future__ import annotations

import threading
from collections.abc import Iterable
from typing import Any

from geometry_msgs.msg import TransformStamped, Vector3
from rclpy.node import Node
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from sailenv_msgs_py.frame_info import WORLD_FRAME_ID, optical_frame_id
from sailenv_msgs_py.transforms import pose_to_msg
from sailenv_ros.frame.frame import Frame
from sailenv_ros.ros.nodes.qos import transform_publishers
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, invert
from sailenv_ros.types.rigs import body_of

__all__ = ["TfTree", "camera_frame_id", "fixed_transforms", "object_frame_id", "transform_of"]


def camera_frame_id(agent: str) -> str:
    """Return the name of the frame of an agent's camera (x forward, y left, z up)."""
    return f"{agent}/camera_frame"


def object_frame_id(name: str) -> str:
    """Return the name of the frame of an object; agents' names have no slash."""
    return f"object/{name}"


def transform_of(pose: Pose, header: Header, child_frame_id: str) -> TransformStamped:
    """Make a transform of a pose in the header's frame."""
    msg = pose_to_msg(pose)
    place = msg.position
    stamped = TransformStamped(header=header, child_frame_id=child_frame_id)
    stamped.transform.translation = Vector3(x=place.x, y=place.y, z=place.z)
    stamped.transform.rotation = msg.orientation
    return stamped


def fixed_transforms(agent: str, extrinsics: Pose | None = None) -> list[TransformStamped]:
    """Return what never changes: agent → camera (they coincide) → optical frame (REP 103).

    With the extrinsics of a camera of a rig, body → camera comes first.
    """
    camera = Camera(intrinsics=CameraIntrinsics(), pose=Pose())
    optical = Pose.from_matrix(camera.world_from_camera)
    carried = [] if extrinsics is None else [(body_of(agent), extrinsics)]
    return [
        *(transform_of(pose, Header(frame_id=body), agent) for body, pose in carried),
        transform_of(Pose(), Header(frame_id=agent), camera_frame_id(agent)),
        transform_of(optical, Header(frame_id=camera_frame_id(agent)), optical_frame_id(agent)),
    ]


class TfTree:
    """Publishes the tree of all agents; thread-safe as rclpy's publishers are.

    Parameters
    ----------
    node : Node
    instances : bool
        True: frames tell the pose of every instance, too, as ``world`` → ``object/<name>``.
    """

    def __init__(self, node: Node, *, instances: bool = False) -> None:
        self._instances = instances
        self._told_ns = -1
        self._telling = threading.Lock()
        self._static: dict[str, list[TransformStamped]] = {}
        self._extrinsics: dict[str, Pose | None] = {}
        self._bodies: frozenset[str] = frozenset()
        self._told_bodies: dict[str, tuple[int, int]] = {}
        self._moving, self._fixed = transform_publishers(node)

    @property
    def wanted(self) -> bool:
        """True if somebody subscribes to /tf."""
        return bool(self._moving.get_subscription_count())

    def set_agents(self, agents: Iterable[AgentSpec]) -> None:
        """Take note of the agents that there are."""
        extrinsics = {spec.name: spec.extrinsics for spec in agents}
        if extrinsics == self._extrinsics:
            return
        self._extrinsics = extrinsics
        with self._telling:
            self._bodies = frozenset(map(body_of, extrinsics))
            told = self._told_bodies.items()
            self._told_bodies = {body: at for body, at in told if body in self._bodies}
        self._static = {name: fixed_transforms(name, pose) for name, pose in extrinsics.items()}
        every = [transform for listed in self._static.values() for transform in listed]
        # One latched message holds them all: a reader that comes late gets the last one alone.
        self._fixed.publish(TFMessage(transforms=every))

    def publish(self, agent: str, pose: Pose, stamp: Any) -> None:
        """Send where an agent is at an instant; of a camera of a rig, where its body is.

        Several cameras see one instant: it is told once, as tf2 warns of repeated ones.
        """
        if not self.wanted:
            return
        extrinsics = self._extrinsics.get(agent)
        body = body_of(agent) or agent
        if extrinsics is not None:
            pose = Pose.from_matrix(pose.matrix() @ invert(extrinsics.matrix()))
        with self._telling:
            at = (stamp.sec, stamp.nanosec)
            if body in self._bodies:
                if self._told_bodies.get(body) == at:
                    return
                self._told_bodies[body] = at
            header = Header(stamp=stamp, frame_id=WORLD_FRAME_ID)
            self._moving.publish(TFMessage(transforms=[transform_of(pose, header, body)]))

    def publish_instances(self, frame: Frame, stamp: Any) -> None:
        """Send where every instance of a frame is, if that is asked for.

        Several agents may see one instant: it is told once, as tf2 warns of repeated ones.
        """
        if not self._instances or frame.states is None or not self.wanted:
            return
        with self._telling:
            # Simulated time goes back with a reset.
            if frame.stamp_ns == self._told_ns:
                return
            self._told_ns = frame.stamp_ns
            header = Header(stamp=stamp, frame_id=WORLD_FRAME_ID)
            names, states = frame.instances, frame.states
            transforms = []
            for row, number in enumerate(states.ids.tolist()):
                if number in names:
                    pose = Pose(tuple(states.positions[row]), tuple(states.orientations[row]))
                    frame_id = object_frame_id(names[number].name)
                    transforms.append(transform_of(pose, header, frame_id))
            self._moving.publish(TFMessage(transforms=transforms))
