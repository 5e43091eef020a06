"""Generated rooms before judges that we did not write: MuJoCo lets them settle, FCL finds overlaps.

    python -m benchmarks.room_judges export --seeds 0 20 FOLDER   # with sailenv_ros
    python benchmarks/room_judges.py judge FOLDER                 # with mujoco and python-fcl alone

`export` writes each room as MJCF, `<kind>_<seed>.xml`: static objects are geometry of the world,
doors are on their hinges, all others are bodies with a free joint; masses are those of the assets.
Convex pieces are meshes. `judge`
steps each for two seconds with MuJoCo's default solver and tells how far each body has moved, then
has FCL (https://github.com/flexible-collision-library/fcl) measure how deep shapes of different
objects lie in each other. Parts of a room stand in one another by construction; those are left out.
"""

from __future__ import annotations

import argparse
import itertools
import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SETTLE_S = 2.0
MOST_MOVED_M = 0.005
MOST_DEPTH_M = 0.002

TURNING_FRICTION_M = 0.002
"""Of what spins and rolls, as `sailenv_ros.world.bodies` has it."""


def main() -> int:
    """Export or judge; 1 if a room fails."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("action", choices=("export", "judge"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 20), metavar=("FIRST", "END"))
    args = parser.parse_args()
    if args.action == "export":
        return _export(args.folder, range(*args.seeds))
    return _judge(args.folder)


# -- with sailenv_ros ----------------------------------------------------------------------


def _export(folder: Path, seeds: range) -> int:
    from sailenv_ros.authoring.room_rules.names import drawn_kind
    from sailenv_ros.authoring.room_rules.rule_files import rules_of
    from sailenv_ros.simulation.scenes import SceneLibrary

    folder.mkdir(parents=True, exist_ok=True)
    library, rules = SceneLibrary(), rules_of()
    for seed in seeds:
        name = f"{drawn_kind(seed, rules)}_{seed}"
        scene = f"generated:{drawn_kind(seed, rules)}:{seed}"
        world = library.build(scene)
        try:
            objects = [_described(body) for body in world.bodies if body.collides]
        finally:
            world.close()
        (folder / f"{name}.json").write_text(json.dumps(objects))
        (folder / f"{name}.xml").write_text(_mjcf(name, objects))
        print(name, flush=True)
    return 0


def _described(body: Any) -> dict[str, Any]:
    """Return an object's pose, mass and shapes, its scale applied."""
    placement = body.placement
    scale = np.asarray(placement.scale)
    mass = placement.mass_kg or placement.asset.mass_kg * float(np.prod(scale))
    return {
        "name": placement.name,
        "static": placement.static,
        "of_room": "room" in placement.asset.tags,
        "mass": mass,
        "friction": placement.friction,
        "joint": _joint(placement),
        "pose": body.world_from_body().tolist(),
        "shapes": [_shape(shape, scale) for shape in placement.asset.collision],
    }


def _joint(placement: Any) -> dict[str, Any] | None:
    """Return the joint of what is fastened to the room."""
    if placement.joint is None:
        return None
    spec = placement.joint.spec
    return {
        "type": spec.type,
        "axis": list(spec.axis),
        "origin": list(spec.origin),
        "range": None if spec.limits is None else [end - spec.start for end in spec.limits],
        "friction": spec.friction,
    }


def _shape(shape: Any, scale: Floats) -> dict[str, Any]:
    kind = type(shape).__name__
    if kind == "BoxShape":
        pose = np.eye(4)
        x, y, z, w = shape.orientation_xyzw
        pose[:3, :3] = _matrix((w, x, y, z))
        pose[:3, 3] = np.asarray(shape.centre_m) * scale
        half = np.asarray(shape.half_extents_m) * scale
        return {"type": "box", "size": half.tolist(), "pose": pose.tolist()}
    if kind == "SphereShape":
        pose = np.eye(4)
        pose[:3, 3] = np.asarray(shape.centre_m) * scale
        return {"type": "sphere", "size": [shape.radius_m * scale[0]], "pose": pose.tolist()}
    if kind == "CylinderShape":
        pose = np.eye(4)
        pose[:3, 3] = np.asarray(shape.centre_m) * scale
        size = [shape.radius_m * scale[0], shape.height_m * scale[2] / 2.0]
        return {"type": "cylinder", "size": size, "pose": pose.tolist()}
    return {"type": "mesh", "points": (np.asarray(shape.points) * scale).tolist()}


def _mjcf(name: str, objects: list[dict[str, Any]]) -> str:
    assets: list[str] = []
    world: list[str] = []
    for number, thing in enumerate(objects):
        pose = np.asarray(thing["pose"])
        geoms = "".join(_geoms(thing, number, assets))
        place = f'pos="{_text(pose[:3, 3])}" quat="{_text(_quaternion(pose[:3, :3]))}"'
        label = quoteattr(thing["name"])
        joint = "" if thing["static"] else _mjcf_joint(thing["joint"])
        world.append(f"<body name={label} {place}>{joint}{geoms}</body>")
    return (
        f'<mujoco model={quoteattr(name)}><compiler angle="radian"/><option timestep="0.002"/>'
        f"<asset>{''.join(assets)}</asset><worldbody>{''.join(world)}</worldbody></mujoco>\n"
    )


def _mjcf_joint(joint: Mapping[str, Any] | None) -> str:
    if joint is None:
        return "<freejoint/>"
    limits = "" if joint["range"] is None else f'range="{_text(np.asarray(joint["range"]))}"'
    return (
        f'<joint type="{joint["type"]}" axis="{_text(np.asarray(joint["axis"]))}" '
        f'pos="{_text(np.asarray(joint["origin"]))}" frictionloss="{joint["friction"]:.6g}" '
        f"{limits}/>"
    )


def _geoms(thing: Mapping[str, Any], number: int, assets: list[str]) -> Iterator[str]:
    count = len(thing["shapes"])
    # Parts of the room and static objects never touch each other: bits keep them from being asked.
    bits = 'contype="1" conaffinity="2"' if thing["static"] else 'contype="2" conaffinity="3"'
    friction = f"{2.0 * thing['friction']:.3g} {TURNING_FRICTION_M} {TURNING_FRICTION_M}"
    look = f'{bits} mass="{thing["mass"] / count:.6g}" condim="6" friction="{friction}"'
    for place, shape in enumerate(thing["shapes"]):
        if shape["type"] == "mesh":
            mesh = f"m{number}_{place}"
            vertices = _text(np.asarray(shape["points"]).ravel())
            assets.append(f'<mesh name="{mesh}" vertex="{vertices}" inertia="convex"/>')
            yield f'<geom type="mesh" mesh="{mesh}" {look}/>'
            continue
        pose = np.asarray(shape["pose"])
        where = f'pos="{_text(pose[:3, 3])}" quat="{_text(_quaternion(pose[:3, :3]))}"'
        size = _text(np.asarray(shape["size"]))
        yield f'<geom type="{shape["type"]}" size="{size}" {where} {look}/>'


def _text(values: Floats) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _matrix(wxyz: tuple[float, ...]) -> Floats:
    w, x, y, z = wxyz
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _quaternion(turn: Floats) -> Floats:
    """Return w, x, y, z of a rotation matrix, by its eigenvector (Bar-Itzhack 2000)."""
    (a, b, c), (d, e, f), (g, h, i) = turn
    k = np.array(
        [
            [a - e - i, d + b, g + c, h - f],
            [d + b, e - a - i, h + f, c - g],
            [g + c, h + f, i - a - e, d - b],
            [h - f, c - g, d - b, a + e + i],
        ]
    )
    x, y, z, w = np.linalg.eigh(k / 3.0)[1][:, -1]
    return np.array([w, x, y, z])


# -- with mujoco and python-fcl ------------------------------------------------------------


def _judge(folder: Path) -> int:
    failed = 0
    moved_most, deepest = 0.0, 0.0
    count = bodies = 0
    for file in sorted(folder.glob("*.json")):
        objects = json.loads(file.read_text())
        moves = _settled(file.with_suffix(".xml"))
        depths = dict(_depths(objects))
        worst = max(moves.items(), key=lambda item: item[1], default=("", 0.0))
        deep = max(depths.items(), key=lambda item: item[1], default=(("", ""), 0.0))
        bad = worst[1] > MOST_MOVED_M or deep[1] > MOST_DEPTH_M
        failed += bad
        count, bodies = count + 1, bodies + len(moves)
        moved_most, deepest = max(moved_most, worst[1]), max(deepest, deep[1])
        print(
            f"{file.stem:<16} {len(objects):4d} objects  moved most {1000 * worst[1]:5.1f} mm "
            f"{worst[0]:<20} deepest {1000 * deep[1]:4.1f} mm {' in '.join(deep[0])}"
            f"{'  FAILS' if bad else ''}",
            flush=True,
        )
    print(
        f"{count} rooms with {bodies} bodies, {failed} fail; "
        f"moved most {1000 * moved_most:.1f} mm, deepest {1000 * deepest:.1f} mm"
    )
    return int(failed > 0)


def _settled(file: Path) -> dict[str, float]:
    """Return how far each body's frame or centre has moved after two seconds, by MuJoCo [m]."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    before = np.stack([data.xpos, data.xipos])
    for _ in range(round(SETTLE_S / model.opt.timestep)):
        mujoco.mj_step(model, data)
    after = np.stack([data.xpos, data.xipos])
    moved = np.linalg.norm(after - before, axis=2).max(axis=0)
    return {
        model.body(number).name: float(moved[number])
        for number in range(1, model.nbody)
        if model.body_jntnum[number]
    }


def _depths(objects: list[dict[str, Any]]) -> Iterator[tuple[tuple[str, str], float]]:
    """Yield how deep objects lie in each other, by FCL [m]."""
    solids = [(thing, list(_solids(thing))) for thing in objects]
    for (one, its), (other, others) in itertools.combinations(solids, 2):
        if one["of_room"] and other["of_room"]:
            continue
        depth = max((_depth(a, b) for a in its for b in others), default=0.0)
        if depth > 0.0:
            yield (one["name"], other["name"]), depth


def _solids(thing: Mapping[str, Any]) -> Iterator[tuple[Any, Floats]]:
    """Yield each shape of an object as FCL has it, with its bounds."""
    import fcl

    pose = np.asarray(thing["pose"])
    for shape in thing["shapes"]:
        own = np.asarray(shape.get("pose", np.eye(4)))
        at = pose @ own
        size = shape["points"] if shape["type"] == "mesh" else shape["size"]
        solid, reach = fcl_solid(shape["type"], np.asarray(size))
        corners = reach @ at[:3, :3].T + at[:3, 3]
        if shape["type"] == "sphere":
            corners = at[:3, 3] + reach
        bounds = np.stack([corners.min(axis=0), corners.max(axis=0)])
        yield fcl.CollisionObject(solid, fcl.Transform(at[:3, :3], at[:3, 3])), bounds


def _depth(first: tuple[Any, Floats], second: tuple[Any, Floats]) -> float:
    (a, box_a), (b, box_b) = first, second
    if (np.maximum(box_a[0], box_b[0]) > np.minimum(box_a[1], box_b[1])).any():
        return 0.0
    return fcl_depth(a, b)


def fcl_solid(kind: str, size: Floats) -> tuple[Any, Floats]:
    """Return a shape as FCL has it, and corners that hold it [m].

    Parameters
    ----------
    kind : {'box', 'sphere', 'cylinder', 'mesh'}
        A mesh is the hull of its corners.
    size : numpy.ndarray
        Half sides (3,), radius (1,), radius and half height (2,), or corners (n, 3) [m].
    """
    import fcl
    from scipy.spatial import ConvexHull

    if kind == "mesh":
        hull = ConvexHull(size)
        faces = np.concatenate([np.full((len(hull.simplices), 1), 3), hull.simplices], axis=1)
        return fcl.Convex(size, len(hull.simplices), faces.ravel()), size
    if kind == "box":
        return fcl.Box(*(2.0 * size)), _corners(*size)
    if kind == "sphere":
        (radius,) = size
        return fcl.Sphere(radius), np.array([[-radius] * 3, [radius] * 3])
    radius, half = size
    return fcl.Cylinder(radius, 2.0 * half), _corners(radius, radius, half)


def _corners(*half: float) -> Floats:
    return np.stack(np.meshgrid(*((-h, h) for h in half)), axis=-1).reshape(-1, 3)


def fcl_depth(a: Any, b: Any) -> float:
    """Return how deep two objects of FCL stand in each other [m]."""
    import fcl

    request = fcl.CollisionRequest(num_max_contacts=16, enable_contact=True)
    result = fcl.CollisionResult()
    fcl.collide(a, b, request, result)
    return max((abs(c.penetration_depth) for c in result.contacts), default=0.0)


if __name__ == "__main__":
    sys.exit(main())
