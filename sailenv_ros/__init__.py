"""A virtual visual environment: furnished, simulated rooms with exact per-pixel ground truth.

`Simulation` is the simulator in this process, without ROS. `Agent` is a camera in a simulator that
runs as a ROS 2 node. `load_scene` reads a scene file, `load_calibration` the lens of a
real camera, `load_rig` several cameras, `show` shows a frame, `export_scene` and `export_asset`
write files of other programs. They are imported when they are first
used, so importing the package imports neither ROS nor OpenGL.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from sailenv_ros.system.interrupts import end_at_interrupts
from sailenv_ros.version import __version__

end_at_interrupts()

if TYPE_CHECKING:
    from sailenv_ros.frame.frame import Frame
    from sailenv_ros.frame.show import show
    from sailenv_ros.ros.client.agent import Agent
    from sailenv_ros.scene.calibration_files import load_calibration, load_rig
    from sailenv_ros.scene.loader import load_scene
    from sailenv_ros.scene_export import export_asset, export_scene
    from sailenv_ros.simulation import Simulation
    from sailenv_ros.types.agents import AgentSpec
    from sailenv_ros.types.camera import Camera, CameraIntrinsics
    from sailenv_ros.types.geometry import Pose, look_at
    from sailenv_ros.types.rigs import RigCamera

__all__ = [
    "Agent",
    "AgentSpec",
    "Camera",
    "CameraIntrinsics",
    "Frame",
    "Pose",
    "RigCamera",
    "Simulation",
    "__version__",
    "export_asset",
    "export_scene",
    "load_calibration",
    "load_rig",
    "load_scene",
    "look_at",
    "show",
]

_HOMES = {
    "Agent": "sailenv_ros.ros.client.agent",
    "AgentSpec": "sailenv_ros.types.agents",
    "Camera": "sailenv_ros.types.camera",
    "CameraIntrinsics": "sailenv_ros.types.camera",
    "Frame": "sailenv_ros.frame.frame",
    "Pose": "sailenv_ros.types.geometry",
    "RigCamera": "sailenv_ros.types.rigs",
    "Simulation": "sailenv_ros.simulation",
    "export_asset": "sailenv_ros.scene_export",
    "export_scene": "sailenv_ros.scene_export",
    "load_calibration": "sailenv_ros.scene.calibration_files",
    "load_rig": "sailenv_ros.scene.calibration_files",
    "load_scene": "sailenv_ros.scene.loader",
    "look_at": "sailenv_ros.types.geometry",
    "show": "sailenv_ros.frame.show",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        value = getattr(importlib.import_module(_HOMES[name]), name)
    except ModuleNotFoundError as missing:
        if (missing.name or "").partition(".")[0] not in {"rclpy", "sailenv_msgs", "sensor_msgs"}:
            raise
        raise ImportError(
            f"{name} needs ROS 2 and the interface package sailenv_msgs, and there is no "
            f"{missing.name} in this Python; scripts/run installs both, or source your ROS 2"
        ) from missing
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
