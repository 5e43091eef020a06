"""Judges pieces from seeds by MuJoCo: it loads each one's MJCF and sweeps each joint.

    python -m benchmarks.judge_furniture --seeds 0 3 curtain blind toy

Each joint goes through its limits in steps, the others at rest but for doors before it, and MuJoCo
measures how deep its hulls stand in those of all else. Prints every fault and the worst figures;
ends with status 1 if a hull is deeper than 1 mm, or an axis is off by more than 1e-6.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np

from sailenv_content.families.registry import family_named, family_names
from sailenv_content.families.source import FamilySource
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.cli.main import main as sailenv

MOST_M, MOST_AXIS, STEPS = 0.001, 1e-6, 9
COLLIDES = 3
"""Group of the geometries that collide."""


class Model:
    """A piece as MuJoCo has it."""

    def __init__(self, name: str, folder: Path) -> None:
        file = folder / "piece.xml"
        sailenv(["assets", "export", name, "-o", str(file), "--overwrite"])
        self.m = mujoco.MjModel.from_xml_path(str(file))
        self.d = mujoco.MjData(self.m)
        solid = np.flatnonzero(self.m.geom_group == COLLIDES)
        self.of_body: dict[int, list[int]] = {}
        for geom in solid.tolist():
            self.of_body.setdefault(int(self.m.geom_bodyid[geom]), []).append(geom)

    def joint(self, part: str) -> int:
        """Return the joint of a part, by the end of its name."""
        names = {
            mujoco.mj_id2name(self.m, mujoco.mjtObj.mjOBJ_JOINT, n): n for n in range(self.m.njnt)
        }
        found = [number for name, number in names.items() if name.endswith(f" {part}")]
        return min(
            found, key=lambda n: len(mujoco.mj_id2name(self.m, mujoco.mjtObj.mjOBJ_JOINT, n))
        )

    def depth_m(self, joint: int, positions: dict[int, float]) -> float:
        """Return how deep a joint's body stands in another, with joints at positions [m]."""
        self.d.qpos[:] = 0.0
        for number, position in positions.items():
            self.d.qpos[self.m.jnt_qposadr[number]] = position
        mujoco.mj_kinematics(self.m, self.d)
        mujoco.mj_comPos(self.m, self.d)
        mine = int(self.m.jnt_bodyid[joint])
        deepest = 0.0
        for body, geoms in self.of_body.items():
            if body == mine:
                continue
            for one in self.of_body.get(mine, ()):
                for other in geoms:
                    apart = np.linalg.norm(self.d.geom_xpos[one] - self.d.geom_xpos[other])
                    if apart > self.m.geom_rbound[one] + self.m.geom_rbound[other]:
                        continue
                    gap = mujoco.mj_geomDistance(self.m, self.d, one, other, 0.01, None)
                    deepest = max(deepest, -gap)
        return deepest


def faults(name: str, library: AssetLibrary, folder: Path) -> Iterator[tuple[str, float, float]]:
    """Yield each part that moves, with its depth [m] and the error of its axis."""
    asset = library.get(name)
    if not asset.moving:
        return
    model = Model(name, folder)
    limits = {part.name: part.limits for part in asset.moving}
    for part in asset.moving:
        joint = model.joint(part.name)
        axis = float(np.abs(model.m.jnt_axis[joint] - part.axis).max())
        worst = 0.0
        for position in np.linspace(*part.limits, STEPS).tolist():
            at = {joint: position}
            depth = model.depth_m(joint, at)
            if depth > MOST_M:  # it may be behind doors
                doors = [n for n in limits if ("door" in n or "flap" in n or n == "lid")]
                at |= {model.joint(n): limits[n][1] for n in doors if n != part.name}
                depth = min(depth, model.depth_m(joint, at))
            worst = max(worst, depth)
        yield part.name, worst, axis


def main() -> int:
    """Judge the families that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("families", nargs="*", help="(default: all)")
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 1), metavar=("FIRST", "END"))
    args = parser.parse_args()
    library = AssetLibrary([FamilySource()])
    pieces = joints = faulty = 0
    deepest = off = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for family in args.families or family_names():
            for style in family_named(family).styles:
                for seed in range(*args.seeds):
                    name = f"{family}~{style}:{seed}"
                    pieces += 1
                    for part, depth, axis in faults(name, library, Path(folder)):
                        joints += 1
                        deepest, off = max(deepest, depth), max(off, axis)
                        if depth > MOST_M or axis > MOST_AXIS:
                            faulty += 1
                            print(f"{name}: {part} {1000.0 * depth:.1f} mm, axis {axis:.1e}")
    print(
        f"{pieces} pieces, {joints} joints, {faulty} at fault; deepest {1000.0 * deepest:.2f} mm, "
        f"axes off by at most {off:.1e}",
        file=sys.stderr,
    )
    return int(faulty > 0)


if __name__ == "__main__":
    raise SystemExit(main())
