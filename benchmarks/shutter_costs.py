"""Time frames of a rolling shutter and of an exposure time beside those of a global shutter.

    python benchmarks/shutter_costs.py [--scene NAME] [--size WxH] [--frames N] [--threads N]

The five views of an agent from one place, by the native renderer, each shutter in turn, so that
what disturbs the machine disturbs all. The camera moves by 0.5 m/s and turns by 30 degrees a
second; with "things" ten objects move, too.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import FIVE_VIEWS

EYE, TARGET = (2.1, -1.25, 1.55), (-1.2, 0.95, 0.85)
ROW_S, EXPOSURE_S, SAMPLES = 3e-5, 0.01, 4
SPEED_M_S, TURN_DEG_S = 0.5, 30.0
WARM_UP = 2


def seen_at(
    lens: CameraIntrinsics, snapshot: WorldSnapshot, time_s: float, moving: int, *, rolls: bool
) -> Observation:
    """Return what a camera observes around an instant."""

    def pose(at_s: float) -> Pose:
        start = look_at(EYE, TARGET)
        roll, pitch, yaw = start.rpy_deg
        turn = (roll, pitch, yaw + TURN_DEG_S * at_s)
        return Pose.from_rpy_deg(np.add(EYE, (SPEED_M_S * at_s, 0.0, 0.0)), turn)

    camera = Camera(intrinsics=lens, pose=pose(time_s))
    observed = Observation(snapshot=snapshot, camera=camera)
    if not rolls:
        return observed
    times = time_s + (np.arange(lens.height) - 0.5 * (lens.height - 1)) * ROW_S
    cameras = [Camera(intrinsics=lens, pose=pose(t)).world_from_camera for t in times]
    stand = snapshot.world_from_body[:moving]
    poses = np.broadcast_to(stand, (lens.height, *stand.shape)).copy()
    poses[:, :, 0, 3] += SPEED_M_S * times[:, None]
    rows = RowPoses(
        times_ns=np.round(1e9 * times).astype(np.int64),
        world_from_camera=np.stack(cameras),
        ids=snapshot.contents.instance_ids[:moving].copy(),
        world_from_instance=poses,
    )
    return replace(observed, rows=rows)


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="room_01")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--threads", type=int)
    arguments = parser.parse_args()
    width, height = (int(number) for number in arguments.size.split("x"))
    lens = CameraIntrinsics(width=width, height=height)
    world = SceneLibrary().build(arguments.scene)
    world.step(8)
    before = world.snapshot()
    world.step(8)
    now = world.snapshot()
    world.close()
    renderer = NativeRenderer(threads=arguments.threads)
    kinds: Mapping[str, tuple[bool, int, int]] = {
        "global": (False, 0, 1),
        "rolling": (True, 0, 1),
        "rolling, things": (True, 10, 1),
        f"global, {SAMPLES} instants": (False, 0, SAMPLES),
    }
    wall, cpu = defaultdict(list), defaultdict(list)
    for number in range(WARM_UP + arguments.frames):
        for name, (rolls, moving, samples) in kinds.items():
            past = seen_at(lens, before, 0.0, moving, rolls=rolls)
            seen = seen_at(lens, now, 1.0 / 30.0, moving, rolls=rolls)
            instants = 1.0 / 30.0 + EXPOSURE_S * ((np.arange(samples) + 0.5) / samples - 0.5)
            averaged = tuple(
                seen_at(lens, now, float(t), moving, rolls=rolls) for t in instants if samples > 1
            )
            past = replace(past, depth=_depth(renderer, past))
            began, used = time.perf_counter(), time.process_time()
            renderer.render(
                RenderRequest(
                    seen.snapshot, seen.camera, FIVE_VIEWS, past, rows=seen.rows, samples=averaged
                )
            )
            if number >= WARM_UP:
                wall[name].append(time.perf_counter() - began)
                cpu[name].append(time.process_time() - used)
    renderer.close()
    base_wall, base_cpu = (statistics.median(t["global"]) for t in (wall, cpu))
    print(f"{arguments.scene}, {width} x {height}, five views: wall, processor [ms], ratios")
    for name in kinds:
        own_wall, own_cpu = statistics.median(wall[name]), statistics.median(cpu[name])
        print(
            f"{name:20s} {1e3 * own_wall:7.2f} {1e3 * own_cpu:7.2f}"
            f"  x {own_wall / base_wall:.2f}  x {own_cpu / base_cpu:.2f}"
        )


def _depth(renderer: NativeRenderer, seen: Observation) -> NDArray[np.float32]:
    """Return the depth of an observation, which a frame before would have left."""
    views = renderer.render(
        RenderRequest(seen.snapshot, seen.camera, ("depth",), rows=seen.rows)
    ).views
    depth: NDArray[np.float32] = views["depth"]
    return depth


if __name__ == "__main__":
    main()
