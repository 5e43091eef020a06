"""`sailenv run`: start the simulator, as a ROS 2 node or, where there is no ROS, without."""

from __future__ import annotations

import argparse
import contextlib
import logging
import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

from sailenv_ros.cli.arguments import add_allow_modules, add_any_light
from sailenv_ros.dataset.live_capture import LiveCapture
from sailenv_ros.errors import SimulationClosed
from sailenv_ros.gateway import DEFAULT_HOST, DEFAULT_PORT, GatewayServer
from sailenv_ros.gateway.protocol_commands import Protocol
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.background_build import BackgroundBuild, furnishing
from sailenv_ros.system.memory import keep_freed_memory, share_freed_memory
from sailenv_ros.system.transport import stay_local
from sailenv_ros.viewer import DEFAULT_HOST as VIEWER_HOST
from sailenv_ros.viewer import DEFAULT_PORT as VIEWER_PORT
from sailenv_ros.viewer import ViewerServer

__all__ = ["add_parser", "run"]

LOOK_S = 0.25
"""Time between two checks of whether the simulation still runs [s]."""


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "run",
        help="start the simulator, with or without ROS",
        description="Starts the simulator and lets SAILenv clients connect; "
        "a browser shows what its agents see.",
    )
    parser.set_defaults(run=run)
    parser.add_argument("scene", nargs="?", help="name or file (default: a furnished room)")
    parser.add_argument("--no-ros", action="store_true", help="without topics and services")
    parser.add_argument("--host", default=DEFAULT_HOST, help="address (default: %(default)s)")
    parser.add_argument(
        "--port", type=int, default=DEFAULT_PORT, help="TCP port (default: %(default)s)"
    )
    parser.add_argument("--protocol", choices=get_args(Protocol), default="0.5")
    parser.add_argument(
        "--viewer-port", type=int, default=VIEWER_PORT, metavar="PORT",
        help="of the web viewer; 0: none (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--viewer-host", default=VIEWER_HOST, metavar="HOST",
        help="address of the web viewer; 0.0.0.0: all, with a token (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--viewer-control", action="store_true",
        help="let those from other machines not only watch but change things",
    )  # fmt: skip
    parser.add_argument("--seed", type=int, default=0, help="of every random number")
    parser.add_argument(
        "--no-build",
        action="store_true",
        help="do not build in the background what the scene lacks of furniture and baked light",
    )
    parser.add_argument(
        "--scenes", type=Path, action="append", default=[], metavar="DIR", help="more scenes"
    )
    add_any_light(parser)
    add_allow_modules(parser)


def run(args: argparse.Namespace) -> int:
    """Run until it is ended by Ctrl-C or SIGTERM; 0 then."""
    return _run_alone(args) if args.no_ros else _become_the_node(args)


def _become_the_node(args: argparse.Namespace) -> int:
    """Replace this process by the node's, which has a main program of its own."""
    values: dict[str, object] = {
        "scene": args.scene or "",
        "seed": args.seed,
        "gateway.host": args.host,
        "gateway.port": args.port,
        "gateway.protocol": f"'{args.protocol}'",  # a text, not a number
        "viewer.host": args.viewer_host,
        "viewer.port": args.viewer_port,
        "allow_modules": str(args.allow_modules).lower(),
        "light": args.light,
        "viewer.control": str(args.viewer_control).lower(),
        "build_missing": "nothing" if args.no_build else "scene",
    }
    if args.scenes:
        values["scene_paths"] = "[" + ", ".join(f"'{path}'" for path in args.scenes) + "]"
    given = [word for name, value in values.items() for word in ("-p", f"{name}:={value}")]
    command = [sys.executable, "-m", "sailenv_ros.ros.nodes.sim_node", "--ros-args", *given]
    stay_local()
    sys.stdout.flush()
    os.execv(sys.executable, command)


def _run_alone(args: argparse.Namespace) -> int:
    logging.basicConfig(level=logging.INFO, format="%(levelname)s: %(message)s")
    keep_freed_memory()
    share_freed_memory()
    # A shell starts what it puts into the background with SIGINT ignored; who sends it means it.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    with Simulation(
        args.scene,
        seed=args.seed,
        scene_paths=args.scenes,
        allow_modules=args.allow_modules,
        light=args.light,
    ) as simulation:
        server = GatewayServer(
            simulation, host=args.host, port=args.port, protocol=args.protocol
        )  # fmt: skip
        with server, _viewer(simulation, args) as viewer, _background_build(simulation, args):
            print(f"scene {simulation.info.scene!r}; renderer: {simulation.info.renderer}")
            print(
                f"listening on {server.host}:{server.port} for SAILenv clients "
                f"(protocol {args.protocol}); Ctrl-C ends it",
                flush=True,
            )
            if viewer is not None:
                print(f"open {viewer.url} in a browser to see it", flush=True)
            _wait_for_the_end(simulation)
            # A second Ctrl-C shall not break the clean-up off.
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
    return 0


def _background_build(
    simulation: Simulation, args: argparse.Namespace
) -> contextlib.AbstractContextManager[object]:
    if args.no_build:
        return contextlib.nullcontext()
    step = furnishing(
        str(args.scene or simulation.info.scene),
        everything=False,
        scene_paths=args.scenes,
        allow_modules=args.allow_modules,
        light=args.light != "plain",
    )
    return BackgroundBuild(simulation, [step])


@contextlib.contextmanager
def _viewer(simulation: Simulation, args: argparse.Namespace) -> Iterator[ViewerServer | None]:
    """Serve the web viewer while the block runs, unless its port is 0."""
    if not args.viewer_port:
        yield None
        return
    with ViewerServer(
        simulation,
        host=args.viewer_host,
        port=args.viewer_port,
        control=args.viewer_control,
        data_sets=LiveCapture(),
    ) as viewer:
        yield viewer


def _wait_for_the_end(simulation: Simulation) -> None:
    try:
        while not simulation.closed:
            time.sleep(LOOK_S)
    except KeyboardInterrupt:
        return
    raise SimulationClosed("of an error, which the log shows")
