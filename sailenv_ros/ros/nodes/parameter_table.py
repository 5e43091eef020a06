"""The parameters of sim_node as a table: description, range or choices; and as a dataclass.

They say how to run, never what a scene is. Those in `LIVE` may be changed while the node runs (see
`live_parameters`); a change of another is refused by ROS, and its description says what to use.
Knows no ROS, so that a simulator that starts before ROS is installed reads the same table.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast, get_args

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.gateway import DEFAULT_HOST, DEFAULT_PORT
from sailenv_ros.gateway.protocol_commands import Protocol
from sailenv_ros.render.contract import BACKEND_NAMES, BackendName
from sailenv_ros.types.agents import RATE, AgentSpec
from sailenv_ros.types.camera import INTRINSICS_LIMITS, CameraIntrinsics
from sailenv_ros.types.lens_settings import PINHOLE_FOV
from sailenv_ros.types.light_choice import LIGHTS, LightChoice
from sailenv_ros.types.scene_info import REAL_TIME_FACTOR, TimeMode
from sailenv_ros.types.validation import SEED, Bounds
from sailenv_ros.types.views import FIVE_VIEWS, RENDERED_VIEWS
from sailenv_ros.viewer import DEFAULT_HOST as VIEWER_HOST
from sailenv_ros.viewer import DEFAULT_PORT as VIEWER_PORT

__all__ = [
    "LIVE",
    "NAMESPACE",
    "PARAMETERS",
    "USE_SIM_TIME",
    "Parameter",
    "SimParameters",
    "sim_parameters",
    "without_a_clock",
]

NAMESPACE = "/sailenv"
"""The nodes', unless ROS is told another."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimParameters:
    """Parameters of the simulator node, checked.

    Attributes
    ----------
    scene : str
    mode : {'realtime', 'lockstep'}
    real_time_factor : float
    seed : int
    paused : bool
    backend : {'auto', 'native', 'gl'}
    render_device : int or None
    scene_paths : tuple of Path
    allow_modules : bool
    build_missing : {'nothing', 'scene', 'all'}
    publish_clock : bool
    publish_instance_tf : bool
    gateway_host : str
    gateway_port : int
        0 for none.
    gateway_protocol : {'0.5', '0.6'}
    viewer_host : str
    viewer_port : int
        0 for none.
    viewer_control : bool
    agent : AgentSpec or None
        The agent that is there from the start.
    """

    scene: str | None
    mode: TimeMode
    real_time_factor: float
    seed: int
    paused: bool
    backend: BackendName
    render_device: int | None
    scene_paths: tuple[Path, ...]
    allow_modules: bool
    light: LightChoice
    build_missing: str
    publish_clock: bool
    publish_instance_tf: bool
    gateway_host: str
    gateway_port: int
    gateway_protocol: str
    viewer_host: str
    viewer_port: int
    viewer_control: bool
    agent: AgentSpec | None


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a node: default, description, bounds or choices."""

    default: Any
    description: str
    bounds: Bounds | None = None
    choices: tuple[str, ...] = ()

    def of_wrong_type(self, name: str, given: object) -> InvalidRequest:
        """Return the error that names the type which is wanted."""
        return InvalidRequest(f"parameter {name}", given, f"of the type of {self.default!r}")

    def out_of_range(self, name: str, given: object) -> InvalidRequest:
        """Return the error that names the range."""
        accepted = "" if self.bounds is None else self.bounds.accepted
        return InvalidRequest(f"parameter {name}", given, accepted)

    def check_choice(self, name: str, value: object) -> None:
        """Refuse a text that is none of the choices."""
        if self.choices and isinstance(value, str) and value not in self.choices:
            raise UnknownName(f"parameter {name}", value, self.choices)


LIVE = ("real_time_factor", "agent.rate_hz")
"""Parameters that take effect while the node runs."""

USE_SIM_TIME = "use_sim_time"
"""A parameter of every node of ROS: follow /clock."""

_PORT = Bounds(least=0, most=65535, whole=True)
_DEVICE = Bounds(least=-1, most=15, whole=True)

PARAMETERS: dict[str, Parameter] = {
    "scene": Parameter(
        "",
        "Name of the first scene, or the path of a scene file; later: the service change_scene. "
        "Empty: room_01, or optical where the furniture has not been built.",
    ),
    "scene_paths": Parameter([""], "More folders with scenes; an empty path counts for nothing."),
    "allow_modules": Parameter(
        False,
        "True: scene files may have behaviours of Python modules, whose code runs in this process.",
    ),
    "mode": Parameter(
        "realtime",
        "realtime: simulated time follows the wall clock; lockstep: it moves by the step service.",
        choices=("realtime", "lockstep"),
    ),
    "real_time_factor": Parameter(
        1.0, "Simulated seconds per wall second, in realtime mode.", REAL_TIME_FACTOR
    ),
    "seed": Parameter(
        0, "Seed of every random number of the scene; later: the service reset.", SEED
    ),
    "paused": Parameter(
        False,
        "True: start with simulated time standing still; later: the services pause and resume.",
    ),
    "backend": Parameter(
        "auto",
        "Renderer: gl = OpenGL, native = made for processors, auto = gl on graphics hardware, else "
        "native.",
        choices=BACKEND_NAMES,
    ),
    "render_device": Parameter(-1, "Number of the EGL device; -1: the best there is.", _DEVICE),
    "light": Parameter(
        "newest",
        "Light of rooms: newest = what is baked by now, or is being baked; baked = the finished "
        "light, or no start; plain = without bounced light.",
        choices=LIGHTS,
    ),
    "build_missing": Parameter(
        "nothing",
        "What is built in the background: furniture and light that the first scene lacks, or all.",
        choices=("nothing", "scene", "all"),
    ),
    "publish_clock": Parameter(
        True, "True: publish simulated time on /clock, unless another simulator there does."
    ),
    "publish_instance_tf": Parameter(
        False, "True: every published frame tells the poses of all objects on /tf (object/<name>)."
    ),
    "gateway.port": Parameter(
        DEFAULT_PORT, "TCP port for SAILenv clients; 0: none.", _PORT
    ),
    "gateway.host": Parameter(
        DEFAULT_HOST, "Address that port listens on; 0.0.0.0: all, without any password."
    ),
    "gateway.protocol": Parameter(
        "0.5", "Revision of those clients: 0.5 is that of PyPI.", choices=get_args(Protocol)
    ),
    "viewer.port": Parameter(
        VIEWER_PORT, "TCP port of the web viewer; 0: none.", _PORT
    ),
    "viewer.host": Parameter(
        VIEWER_HOST, "Address that port listens on; 0.0.0.0: all, with a token in the URL."
    ),
    "viewer.control": Parameter(
        False, "True: those from other machines may change things there, not only watch."
    ),
    "agent.name": Parameter("agent", "Name of the first agent; empty: start without one."),
    "agent.width": Parameter(640, "Width of its pictures [px].", INTRINSICS_LIMITS["width"]),
    "agent.height": Parameter(480, "Height of its pictures [px].", INTRINSICS_LIMITS["height"]),
    "agent.vertical_fov_deg": Parameter(
        60.0, "Full vertical angle of view [deg].", PINHOLE_FOV
    ),
    "agent.cx_offset_px": Parameter(
        0.0, "From the picture's centre to the optical axis, to the right [px].",
        INTRINSICS_LIMITS["cx_offset_px"],
    ),
    "agent.cy_offset_px": Parameter(
        0.0, "From the picture's centre to the optical axis, down [px].",
        INTRINSICS_LIMITS["cy_offset_px"],
    ),
    "agent.near_m": Parameter(0.05, "Nearest depth that is seen [m].", INTRINSICS_LIMITS["near_m"]),
    "agent.far_m": Parameter(100.0, "Farthest depth that is seen [m].", INTRINSICS_LIMITS["far_m"]),
    "agent.depth_range_m": Parameter(
        10.0, "Depth that the 8-bit depth picture shows as black [m].", INTRINSICS_LIMITS["far_m"]
    ),
    "agent.rate_hz": Parameter(
        30.0, "Frames per simulated second; 0: on request only [Hz].", RATE
    ),
    "agent.views": Parameter(
        list(FIVE_VIEWS), "Views of a captured frame unless the request names others.",
        choices=RENDERED_VIEWS,
    ),
    "agent.following": Parameter(True, "True: it takes over the pose of its mover."),
    "agent.mover": Parameter("", "Name of the mover; empty: the scene's first."),
}  # fmt: skip


def sim_parameters(values: Mapping[str, Any]) -> SimParameters:
    """Return the parameters with values that have been checked, by their names in the table."""
    return SimParameters(
        scene=values["scene"] or None,
        mode=cast(TimeMode, values["mode"]),
        real_time_factor=values["real_time_factor"],
        seed=values["seed"],
        paused=values["paused"],
        backend=cast(BackendName, values["backend"]),
        render_device=None if values["render_device"] < 0 else values["render_device"],
        scene_paths=tuple(Path(path) for path in values["scene_paths"] if path),
        allow_modules=values["allow_modules"],
        light=cast(LightChoice, values["light"]),
        build_missing=values["build_missing"],
        publish_clock=values["publish_clock"],
        publish_instance_tf=values["publish_instance_tf"],
        gateway_host=values["gateway.host"],
        gateway_port=values["gateway.port"],
        gateway_protocol=values["gateway.protocol"],
        viewer_host=values["viewer.host"],
        viewer_port=values["viewer.port"],
        viewer_control=values["viewer.control"],
        agent=_agent(values),
    )


def without_a_clock(given: object) -> InvalidRequest:
    """Return the error for a simulator that shall follow the clock that it publishes."""
    accepted = "false for the simulator, which is the source of simulated time"
    return InvalidRequest(f"parameter {USE_SIM_TIME}", given, accepted)


def _agent(values: Mapping[str, Any]) -> AgentSpec | None:
    if not values["agent.name"]:
        return None
    return AgentSpec(
        name=values["agent.name"],
        intrinsics=CameraIntrinsics(
            **{
                name: values[f"agent.{name}"]
                for name in INTRINSICS_LIMITS
                if f"agent.{name}" in PARAMETERS
            }
        ),
        depth_range_m=values["agent.depth_range_m"],
        rate_hz=values["agent.rate_hz"],
        views=tuple(values["agent.views"]),
        following=values["agent.following"],
        mover=values["agent.mover"],
    )
