"""`sailenv record`: keep what agents see in an MCAP bag, of a running simulator or in process.

With ``--lockstep`` it runs a simulation of its own and every frame is kept exactly once; without,
it becomes the recorder node, which listens to a simulator.
"""

from __future__ import annotations

import argparse
import sys
import time
from datetime import datetime
from pathlib import Path
from typing import Any

from sailenv_ros.cli.arguments import add_allow_modules, add_light
from sailenv_ros.cli.node_process import become_node
from sailenv_ros.recording.progress import progress_line, size_in_bytes
from sailenv_ros.recording.topics import RecordingOptions

__all__ = ["add_parser", "run"]

_DESCRIPTION = (
    "Keep what agents see in an MCAP bag. Without --lockstep it records a running simulator's"
    " topics until Ctrl-C; with it, frames are rendered here, each exactly once."
)


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "record", help="record what agents see in an MCAP bag", description=_DESCRIPTION
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "-o", "--output", type=Path, metavar="BAG", help="folder to make (default: by the time)"
    )
    parser.add_argument("--agents", nargs="+", default=[], metavar="NAME", help="default: all")
    parser.add_argument("--views", nargs="+", default=[], metavar="VIEW", help="default: all five")
    parser.add_argument(
        "--amodal", action="store_true", help="draw each object alone: record amodal masks too"
    )
    parser.add_argument("--namespace", default="/sailenv", help="default: %(default)s")
    parser.add_argument("--compression", choices=("zstd", "lz4", "none"), default="zstd")
    parser.add_argument("--split-size", default="0", metavar="SIZE", help="per file, e.g. 2G")
    parser.add_argument("--split-time", type=float, default=0.0, metavar="S", help="per file [s]")
    parser.add_argument(
        "--snapshot", type=float, default=0.0, metavar="S",
        help="keep the last S seconds in memory, and write them when asked [s]",
    )  # fmt: skip
    parser.add_argument("--quiet", action="store_true", help="no progress line")
    _add_lockstep(parser.add_argument_group("in process"))


def _add_lockstep(group: Any) -> None:
    group.add_argument("--lockstep", action="store_true", help="simulate and render here")
    group.add_argument("--frames", type=int, metavar="N", help="frames of each agent")
    group.add_argument("--scene", help="name or file (default: what the simulator starts with)")
    group.add_argument("--seed", type=int, default=0)
    group.add_argument(
        "--facts", action="store_true", help="keep what questions need: contacts, materials, …"
    )
    group.add_argument("--width", type=int, default=640, help="of an agent made here [px]")
    group.add_argument("--height", type=int, default=480, help="of an agent made here [px]")
    group.add_argument("--rate", type=float, default=30.0, help="of an agent made here [Hz]")
    add_allow_modules(group)
    add_light(group, "baked")
    group.add_argument("--backend", choices=("auto", "native", "gl"), default="auto")


def run(args: argparse.Namespace) -> int:
    """Record; 0 if everything was kept, 1 if messages were lost."""
    options = RecordingOptions(
        compression=args.compression,
        split_bytes=size_in_bytes(args.split_size),
        split_s=args.split_time,
    )
    output = args.output or Path(datetime.now().strftime("recording_%Y_%m_%d-%H_%M_%S"))
    if args.lockstep:
        return _lockstep(args, output, options)
    if args.frames is not None:
        print("sailenv record: --frames needs --lockstep", file=sys.stderr)
        return 2
    return _become_the_node(args, output, options)


def _lockstep(args: argparse.Namespace, output: Path, options: RecordingOptions) -> int:
    from sailenv_ros.cli.scene_bake import ensure_baked
    from sailenv_ros.recording.lockstep import record_lockstep
    from sailenv_ros.recording.writer import RecordingWriter, check_free
    from sailenv_ros.simulation import Simulation
    from sailenv_ros.simulation.first_scene import default_scene
    from sailenv_ros.types.agents import AgentSpec
    from sailenv_ros.types.camera import CameraIntrinsics

    if args.frames is None:
        print("sailenv record: --lockstep needs --frames N", file=sys.stderr)
        return 2
    intrinsics = CameraIntrinsics(width=args.width, height=args.height)
    spec = AgentSpec(name="agent", intrinsics=intrinsics, rate_hz=args.rate)
    scene = args.scene or default_scene()
    check_free(output)
    if args.light == "baked":
        ensure_baked(scene, allow_modules=args.allow_modules)
    with Simulation(
        scene,
        mode="lockstep",
        seed=args.seed,
        backend=args.backend,
        allow_modules=args.allow_modules,
        light=args.light,
    ) as simulation:
        if not simulation.info.agents:
            simulation.register_agent(spec)
        with RecordingWriter(output, options) as writer:
            progress = _Progress(writer, quiet=args.quiet)
            record_lockstep(
                simulation,
                writer,
                frames=args.frames,
                agents=args.agents,
                views=args.views,
                amodal=args.amodal,
                facts=args.facts,
                namespace=args.namespace,
                on_frame=progress.frame_done,
            )
        progress.end()
    print(output)
    return 0


def _become_the_node(args: argparse.Namespace, output: Path, options: RecordingOptions) -> int:
    """Replace this process by the recorder node, which takes the same options as parameters."""
    parameters: dict[str, object] = {
        "output": str(output),
        "compression": options.compression,
        "split_bytes": options.split_bytes,
        "split_s": float(options.split_s),
        "progress": not args.quiet,
        "snapshot_s": float(args.snapshot),
        "amodal": args.amodal,
    }
    if args.agents:
        parameters["agents"] = args.agents
    if args.views:
        parameters["views"] = args.views
    become_node("recorder", parameters, namespace=args.namespace)


class _Progress:
    """One line on standard error that is written over and over, on a terminal."""

    def __init__(self, writer: Any, *, quiet: bool) -> None:
        self._writer = writer
        self._quiet = quiet
        self._began_s = self._reported_s = time.monotonic()
        self._frames = 0

    def frame_done(self, count: int) -> None:
        self._frames = count
        now = time.monotonic()
        if now - self._reported_s >= 0.5 and sys.stderr.isatty():
            self._reported_s = now
            self._report("\r")

    def end(self) -> None:
        self._report("\r" if sys.stderr.isatty() else "")
        if not self._quiet:
            print(file=sys.stderr)

    def _report(self, begin: str) -> None:
        if self._quiet:
            return
        statistics = self._writer.statistics
        line = progress_line(
            frames=self._frames,
            message_bytes=statistics.message_bytes,
            file_bytes=statistics.file_bytes,
            elapsed_s=time.monotonic() - self._began_s,
            dropped=statistics.lost,
        )
        print(f"{begin}{line}", end="", file=sys.stderr, flush=True)
