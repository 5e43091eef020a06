"""`sailenv scene render`: the five views of a scene from a viewpoint, on one sheet."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros.cli.arguments import add_allow_modules, add_any_light
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet, save_picture
from sailenv_ros.scene.scene_catalogue import SUFFIXES
from sailenv_ros.simulation.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import INTRINSICS_LIMITS, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.lens_settings import PINHOLE_FOV
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND
from sailenv_ros.types.validation import checked_integer
from sailenv_ros.types.views import FIVE_VIEWS, VIEWS

__all__ = ["add_arguments", "render_scene"]

CAMERA = "scene_render_camera"
"""Its agent; the scene may have agents of its own."""

DEFAULT_EYE_M = (0.0, 0.0, 1.5)
"""Position of the camera if only its target is given [m]."""

PICTURE_SUFFIXES = (".png", ".jpg")

FLOW_STEPS = 8
"""Steps between a picture and its past, which flow needs: 1/30 s."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the action takes."""
    parser.add_argument("scene", metavar="FILE", help="a YAML file, or a scene's name")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE")
    parser.add_argument(
        "--position", type=float, nargs=3, metavar=("X", "Y", "Z"), help="of the camera [m]"
    )
    parser.add_argument(
        "--look-at", type=float, nargs=3, metavar=("X", "Y", "Z"), help="what it faces [m]"
    )
    parser.add_argument(
        "--time", type=float, default=[0.0], nargs="+", metavar="S", help="simulated times [s]"
    )
    parser.add_argument("--views", nargs="+", default=list(FIVE_VIEWS), metavar="VIEW")
    parser.add_argument("--width", type=int, default=640, metavar="PX")
    parser.add_argument("--height", type=int, default=480, metavar="PX")
    parser.add_argument("--fov", type=float, default=60.0, metavar="DEG", help="vertical")
    parser.add_argument("--columns", type=int, default=3, metavar="N")
    parser.add_argument(
        "--plain", action="store_true", help="a single view's pixels alone, no label and no border"
    )
    add_any_light(parser)
    add_allow_modules(parser)


def render_scene(args: argparse.Namespace) -> int:
    """Render and save; 0 if all is well.

    The camera stands where the mover is at that time, unless its place is given.
    """
    _check(args)
    scene = Path(args.scene) if Path(args.scene).suffix in SUFFIXES else args.scene
    pictures: dict[str, Any] = {}
    with Simulation(
        scene=scene, mode="lockstep", allow_modules=args.allow_modules, light=args.light
    ) as simulation:
        simulation.register_agent(_eye(args))
        table = simulation.info.categories
        for time_s in sorted(args.time):
            frame = _frame_at(simulation, time_s, args.views)
            label = f"{time_s:g} s " if len(args.time) > 1 else ""
            pictures.update({label + name: p for name, p in _pictures(frame, table).items()})
    if args.plain:
        (picture,) = pictures.values()
        print(save_picture(args.output, picture))
        return 0
    columns = min(args.columns, len(pictures))
    print(save_contact_sheet(args.output, pictures, columns=columns))
    return 0


def _check(args: argparse.Namespace) -> None:
    """Refuse what cannot be drawn, in the words of the command line."""
    if min(args.time) < 0.0:
        raise InvalidRequest("--time", min(args.time), "0 s or later")
    count = len(args.time) * len(set(args.views))
    if args.plain and count != 1:
        accepted = "drawn with --views NAME and no more than one --time: it is one picture"
        raise InvalidRequest("--plain", f"{count} pictures", accepted)
    INTRINSICS_LIMITS["width"].integer("--width", args.width)
    INTRINSICS_LIMITS["height"].integer("--height", args.height)
    PINHOLE_FOV.number("--fov", args.fov)
    checked_integer("--columns", args.columns, 1, 1000)
    for name in args.views:
        if name not in VIEWS:
            raise UnknownName("--views", name, VIEWS)
    eye = tuple(args.position or DEFAULT_EYE_M)
    if args.look_at is not None and tuple(args.look_at) == eye:
        raise InvalidRequest("--look-at", args.look_at, f"another point than --position, {eye}")
    if args.output.suffix.lower() not in PICTURE_SUFFIXES:
        wanted = f"a name that ends in {' or '.join(PICTURE_SUFFIXES)}"
        raise InvalidRequest("--output", str(args.output), wanted)


def _eye(args: argparse.Namespace) -> AgentSpec:
    pose = None
    if args.position is not None or args.look_at is not None:
        pose = Pose(tuple(args.position or DEFAULT_EYE_M))
        if args.look_at is not None:
            pose = look_at(pose.position_m, args.look_at)
    intrinsics = CameraIntrinsics(width=args.width, height=args.height, vertical_fov_deg=args.fov)
    return AgentSpec(
        name=CAMERA, intrinsics=intrinsics, rate_hz=0.0, following=pose is None, pose=pose
    )


def _frame_at(simulation: Simulation, time_s: float, views: list[str]) -> Frame:
    """Return the frame of a time; it has a past, so that flow shows what moves."""
    step = max(FLOW_STEPS, round(time_s * STEPS_PER_SECOND))
    now = simulation.sim_time_ns * STEPS_PER_SECOND // 10**9
    if step - FLOW_STEPS > now:
        simulation.step(step - FLOW_STEPS - now)
    simulation.capture(views, agent=CAMERA)
    simulation.step(FLOW_STEPS)
    return simulation.capture(views, agent=CAMERA)


def _pictures(frame: Frame, table: CategoryTable) -> dict[str, np.ndarray[Any, Any]]:
    shown = (name for name in VIEWS if name in frame.views)  # in the order of their definition
    return {name: view_picture(name, frame.views[name], table=table) for name in shown}
