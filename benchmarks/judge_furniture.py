"""Judges pieces from seeds by MuJoCo and FCL: their MJCF is loaded and each joint swept.

    python -m benchmarks.judge_furniture --seeds 0 8 curtain blind toy

Each joint goes through its limits in steps, the others at rest but for the doors of its cabinet
that it meets: those are opened. MuJoCo moves the parts, and FCL
(https://github.com/flexible-collision-library/fcl) measures how deep the shapes of the one that
moves stand in those of all else. Prints every fault and the worst figures; ends with status 1 if a
shape is deeper than 1 mm at any step, or a joint's axis or origin in MuJoCo's world is off by more
than 1e-6.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import fcl
import mujoco
import numpy as np

from benchmarks.room_judges import Floats, fcl_depth, fcl_solid
from sailenv_content.families.registry import family_named, family_names
from sailenv_content.families.source import FamilySource
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.scene_export import export_asset
from sailenv_ros.types.model import MovingPart

MOST_M, MOST_AXIS, STEPS = 0.001, 1e-6, 17
COLLIDES = 3
"""Group of the geometries that collide."""

KINDS = {
    mujoco.mjtGeom.mjGEOM_BOX: ("box", 3),
    mujoco.mjtGeom.mjGEOM_SPHERE: ("sphere", 1),
    mujoco.mjtGeom.mjGEOM_CYLINDER: ("cylinder", 2),
}
"""By MuJoCo's types: name, and how many numbers give the size."""


class Model:
    """A piece as MuJoCo has it, and its shapes as FCL has them.

    Parameters
    ----------
    name : str
        Of the piece.
    folder : Path
        Gets its files.
    """

    def __init__(self, name: str, folder: Path) -> None:
        file = folder / "piece.xml"
        export_asset(name, file, overwrite=True)
        self._m = mujoco.MjModel.from_xml_path(str(file))
        self._d = mujoco.MjData(self._m)
        self._solids = {
            geom: fcl.CollisionObject(self._shape(geom))
            for geom in np.flatnonzero(self._m.geom_group == COLLIDES).tolist()
        }

    def joint(self, part: str) -> int:
        """Return the number of the joint of a part, which is named after the piece and it."""
        names = [self._m.joint(number).name for number in range(self._m.njnt)]
        return names.index(f"{self._m.body(1).name} {part}")

    def error(self, joint: int, part: MovingPart) -> float:
        """Return how far a joint's axis, or a hinge's origin, is from the part's [m]."""
        self._pose({})
        off = np.abs(self._d.xaxis[joint] - part.axis).max()
        if part.type == "hinge":
            aside = np.cross(self._d.xanchor[joint] - part.origin_m, part.axis)
            off = max(off, np.abs(aside).max())
        return float(off)

    def depths_m(self, joint: int, positions: Mapping[int, float]) -> dict[int, float]:
        """Return how deep a joint's body stands in other bodies, by number [m].

        Parameters
        ----------
        joint : int
        positions : mapping of int to float
            Of joints [rad] or [m]; the others are at 0.
        """
        self._pose(positions)
        of, own = self._m.geom_bodyid, self._m.jnt_bodyid[joint]
        others = np.array([geom for geom in self._solids if of[geom] != own], int)
        deepest: dict[int, float] = {}
        for one in (geom for geom in self._solids if of[geom] == own):
            apart = np.linalg.norm(self._d.geom_xpos[others] - self._d.geom_xpos[one], axis=1)
            near = apart < self._m.geom_rbound[others] + self._m.geom_rbound[one]
            for other in others[near].tolist():
                depth = fcl_depth(self._solids[one], self._solids[other])
                deepest[int(of[other])] = max(deepest.get(int(of[other]), 0.0), depth)
        return deepest

    def body(self, joint: int) -> int:
        """Return the number of the body that a joint moves."""
        return int(self._m.jnt_bodyid[joint])

    def _pose(self, positions: Mapping[int, float]) -> None:
        self._d.qpos[:] = 0.0
        for number, position in positions.items():
            self._d.qpos[self._m.jnt_qposadr[number]] = position
        mujoco.mj_kinematics(self._m, self._d)
        mujoco.mj_comPos(self._m, self._d)
        for geom, solid in self._solids.items():
            turn = self._d.geom_xmat[geom].reshape(3, 3)
            solid.setTransform(fcl.Transform(turn, self._d.geom_xpos[geom]))

    def _shape(self, geom: int) -> object:
        if self._m.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = self._m.geom_dataid[geom]
            first = self._m.mesh_vertadr[mesh]
            corners = self._m.mesh_vert[first : first + self._m.mesh_vertnum[mesh]]
            return fcl_solid("mesh", corners.astype(np.float64))[0]
        kind, numbers = KINDS[mujoco.mjtGeom(self._m.geom_type[geom])]
        size: Floats = self._m.geom_size[geom][:numbers]
        return fcl_solid(kind, size)[0]


def sweeps(name: str, library: AssetLibrary, folder: Path) -> Iterator[tuple[str, float, float]]:
    """Yield each part that moves, with its greatest depth [m] and the error of its axis."""
    asset = library.get(name)
    if not asset.moving:
        return
    model = Model(name, folder)
    for part in asset.moving:
        joint = model.joint(part.name)
        doors = {
            model.joint(door.name): door.limits[1]
            for door in asset.moving
            if door is not part and _is_door(door.name) and _cabinet(door.name, part.name)
        }
        worst = 0.0
        for position in np.linspace(*part.limits, STEPS).tolist():
            depths = model.depths_m(joint, {joint: position})
            met = {d: doors[d] for d in doors if depths.get(model.body(d), 0.0) > 0.0}
            if met:
                depths = model.depths_m(joint, {joint: position, **met})
            worst = max(worst, *depths.values(), 0.0)
        yield part.name, worst, model.error(joint, part)


def _is_door(part: str) -> bool:
    return "door" in part or "flap" in part or part == "lid"


def _cabinet(door: str, part: str) -> bool:
    """Return whether two parts are of one cabinet; pieces of one only do not name it."""
    first, second = (re.match(r"cabinet \d+ ", name) for name in (door, part))
    return (first and first[0]) == (second and second[0])


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
                    for part, depth, axis in sweeps(name, library, Path(folder)):
                        joints += 1
                        deepest, off = max(deepest, depth), max(off, axis)
                        if depth > MOST_M or axis > MOST_AXIS:
                            faulty += 1
                            told = f"{name}: {part} {1000.0 * depth:.1f} mm, axis {axis:.1e}"
                            print(told, flush=True)
    print(
        f"{pieces} pieces, {joints} joints, {faulty} at fault; deepest {1000.0 * deepest:.2f} mm, "
        f"axes off by at most {off:.1e}",
        file=sys.stderr,
    )
    return int(faulty > 0)


if __name__ == "__main__":
    raise SystemExit(main())
