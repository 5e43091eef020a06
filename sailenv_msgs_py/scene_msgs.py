"""`SceneInfo` to and from its message: tables, names, lights, agents.

The message carries of the surroundings what a service can set; reading it back gives the
data types' defaults for the rest (the colours of the sky).
"""

from __future__ import annotations

from typing import cast

from std_msgs.msg import ColorRGBA, Header

import sailenv_msgs.msg as msgs
from sailenv_msgs_py.agent_msgs import agent_spec_from_msg, agent_spec_to_msg
from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.mover_msgs import mover_from_msg, mover_to_msg
from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import (
    point_to_msg,
    vector_to_msg,
    xyz_from_msg,
)
from sailenv_ros.types.labels import Category, CategoryTable, Instance, Keypoint
from sailenv_ros.types.lights import LIGHT_LIMITS, Environment, Light, LightType
from sailenv_ros.types.scene_info import SceneInfo, TimeMode

__all__ = [
    "colour_to_msg",
    "environment_to_msg",
    "instance_to_msg",
    "light_from_msg",
    "light_to_msg",
    "rgb_from_msg",
    "scene_info_from_msg",
    "scene_info_to_msg",
]


def scene_info_to_msg(info: SceneInfo) -> msgs.SceneInfo:
    """Make the message."""
    return msgs.SceneInfo(
        header=Header(stamp=stamp_from_ns(info.sim_time_ns), frame_id=WORLD_FRAME_ID),
        scene=info.scene,
        scenes=list(info.scenes),
        epoch=info.epoch,
        revision=info.revision,
        mode=info.mode,
        paused=info.paused,
        real_time_factor=float(info.real_time_factor),
        seed=info.seed,
        categories=[_category_to_msg(category) for category in info.categories.values()],
        instances=[instance_to_msg(i, moving=i.id in info.moving) for i in info.instances],
        spawnables=list(info.spawnables),
        lights=[light_to_msg(light) for light in info.lights],
        environment=environment_to_msg(info.environment),
        agents=[agent_spec_to_msg(spec) for spec in info.agents],
        movers=[mover_to_msg(mover) for mover in info.movers],
        renderer=info.renderer,
    )


def scene_info_from_msg(msg: msgs.SceneInfo) -> SceneInfo:
    """Read what `scene_info_to_msg` made."""
    return SceneInfo(
        scene=msg.scene,
        scenes=tuple(msg.scenes),
        epoch=msg.epoch,
        revision=msg.revision,
        sim_time_ns=ns_from_stamp(msg.header.stamp),
        mode=cast(TimeMode, msg.mode),
        paused=msg.paused,
        real_time_factor=msg.real_time_factor,
        seed=msg.seed,
        categories=CategoryTable(_category_from_msg(category) for category in msg.categories),
        instances=tuple(_instance_from_msg(instance) for instance in msg.instances),
        moving=frozenset(instance.id for instance in msg.instances if instance.moving),
        spawnables=tuple(msg.spawnables),
        lights=tuple(light_from_msg(light) for light in msg.lights),
        environment=_environment_from_msg(msg.environment),
        agents=tuple(agent_spec_from_msg(agent) for agent in msg.agents),
        movers=tuple(mover_from_msg(mover) for mover in msg.movers),
        renderer=msg.renderer,
    )


def instance_to_msg(instance: Instance, *, moving: bool) -> msgs.Instance:
    """Make the message of one object."""
    return msgs.Instance(
        id=instance.id,
        name=instance.name,
        asset=instance.asset,
        category_id=instance.category_id,
        category=instance.category,
        is_static=instance.static,
        moving=moving,
        low=point_to_msg(instance.low_m),
        high=point_to_msg(instance.high_m),
        parent=instance.parent,
        keypoints=[
            msgs.Keypoint(name=point.name, position=point_to_msg(point.position_m))
            for point in instance.keypoints
        ],
        materials=list(instance.materials),
        painted=instance.painted,
    )


def light_to_msg(light: Light) -> msgs.Light:
    """Make the message of one light; its numbers are of single precision there."""
    return msgs.Light(
        name=light.name,
        type=light.type,
        colour=colour_to_msg(light.colour),
        position=point_to_msg(light.position_m),
        direction=vector_to_msg(light.direction),
        **{name: float(getattr(light, name)) for name in LIGHT_LIMITS},
    )


def light_from_msg(msg: msgs.Light) -> Light:
    """Read one light.

    Raises
    ------
    InvalidRequest
        If a number is out of its range.
    """
    return Light(
        name=msg.name,
        type=cast(LightType, msg.type),
        colour=rgb_from_msg(msg.colour),
        position_m=xyz_from_msg(msg.position),
        direction=xyz_from_msg(msg.direction),
        **{name: float(getattr(msg, name)) for name in LIGHT_LIMITS},
    )


def colour_to_msg(rgb: tuple[float, float, float]) -> ColorRGBA:
    """Make a colour message of three linear numbers; alpha is 1."""
    r, g, b = (float(value) for value in rgb)
    return ColorRGBA(r=r, g=g, b=b, a=1.0)


def rgb_from_msg(msg: ColorRGBA) -> tuple[float, float, float]:
    """Read the three linear numbers of a colour."""
    return float(msg.r), float(msg.g), float(msg.b)


def environment_to_msg(environment: Environment) -> msgs.Environment:
    """Make the message of what can be set of the surroundings."""
    return msgs.Environment(
        ambient=colour_to_msg(environment.ambient),
        sky=environment.background == "sky",
        background_colour=colour_to_msg(environment.background_colour),
        exposure=float(environment.exposure),
    )


def _environment_from_msg(msg: msgs.Environment) -> Environment:
    return Environment(
        ambient=rgb_from_msg(msg.ambient),
        background="sky" if msg.sky else "colour",
        background_colour=rgb_from_msg(msg.background_colour),
        exposure=float(msg.exposure),
    )


def _category_to_msg(category: Category) -> msgs.Category:
    r, g, b = category.colour
    return msgs.Category(id=category.id, name=category.name, r=r, g=g, b=b)


def _category_from_msg(msg: msgs.Category) -> Category:
    return Category(id=msg.id, name=msg.name, colour=(msg.r, msg.g, msg.b))


def _instance_from_msg(msg: msgs.Instance) -> Instance:
    return Instance(
        id=msg.id,
        name=msg.name,
        asset=msg.asset,
        category_id=msg.category_id,
        category=msg.category,
        static=msg.is_static,
        low_m=xyz_from_msg(msg.low),
        high_m=xyz_from_msg(msg.high),
        parent=msg.parent,
        keypoints=tuple(
            Keypoint(name=point.name, position_m=xyz_from_msg(point.position))
            for point in msg.keypoints
        ),
        materials=tuple(msg.materials),
        painted=msg.painted,
    )
