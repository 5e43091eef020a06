"""Figures of people: motion of skin, clothes, walks through generated rooms, cost of a frame.

    python benchmarks/people.py skin                 # flow and tracks against vertices
    python benchmarks/people.py clothes              # skin through clothes, of all people
    python benchmarks/people.py walks --rooms 200 --walks 5
    python benchmarks/people.py walks --animals      # cats and dogs instead
    python benchmarks/people.py cost
    python benchmarks/people.py coco                 # pycocotools: truth against itself

Each prints what docs/people.md tells.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import itertools
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_content.animals.looks import animals
from sailenv_content.people.fetch_bodies import fetch_bodies
from sailenv_content.people.looks import people
from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.frame.motion import ObjectPoints, SceneGeometry, track
from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.footsteps import standing_feet, way_along
from sailenv_ros.postures.skeleton import joint_frames, skin_matrices
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.rays.opaque_models import deformed_model
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.space.free_space import FREE
from sailenv_ros.types.geometry import look_at
from sailenv_ros.world.person_body import PersonBody
from sailenv_ros.world.skin import skin_over
from sailenv_ros.world.world import World

SCENE = """
version: 1
room: {size: [6, 5, 2.6]}
objects:
  - {name: sofa, asset: couch_02, position: [-1.9, 0, 0]}
  - {name: anna, asset: person_01, position: [1.5, -1.2, 0],
     behaviours: [{type: walk_around, pause: [0.3, 0.6]}]}
  - {name: ben, asset: person_02_in_parts, position: [1.2, 1.4, 0],
     behaviours: [{type: sit, sitting: [1, 2]}]}
"""


def scene_file(folder: Path, text: str = SCENE) -> Path:
    """Write a scene; return its path."""
    path = folder / "people.yaml"
    path.write_text(text)
    return path


def skin_motion(frames: int = 200) -> None:
    """Flow at each pixel, and tracks, against the vertices of the triangle that a ray meets."""
    with tempfile.TemporaryDirectory() as folder:
        lens = CameraIntrinsics(width=320, height=240, vertical_fov_deg=60.0)
        eye = AgentSpec(name="eye", intrinsics=lens, following=False)
        with Simulation(scene_file(Path(folder)), mode="lockstep", agent=eye) as simulation:
            simulation.set_pose(look_at((2.7, -2.2, 1.7), (-0.3, 0.3, 0.9)), teleport=True)
            simulation.step(300)
            kept = []
            worst, mean, count = 0.0, 0.0, 0
            for _ in range(frames):
                simulation.step(8)
                frame = simulation.capture(["depth", "instance", "flow", "object_coords"])
                kept.append(frame)
            geometry = SceneGeometry.of_contents(simulation.contents)
    for before, frame in itertools.pairwise(kept):
        errors = flow_errors(frame, before)
        if len(errors):
            worst = max(worst, float(np.quantile(errors, 0.999)))
            mean += float(errors.sum())
            count += len(errors)
    print(f"flow on skin: {count} pixels, mean {mean / count:.1e} px, 99.9 % below {worst:.1e} px")
    first = kept[0]
    assert first.states is not None
    chosen = np.isin(first["instance"], list(first.states.deformations))
    v, u = np.nonzero(chosen)
    picked = np.random.default_rng(1).choice(len(v), 300, replace=False)
    coords = first["object_coords"][v[picked], u[picked]].astype(np.float64)
    ids = first["instance"][v[picked], u[picked]]
    tracks = track(ObjectPoints(ids, coords), kept, geometry)
    errors = track_errors(tracks, kept)
    print(
        f"tracks: {len(picked)} points, {len(kept)} frames, mean {errors.mean():.1e} px, "
        f"most {errors.max():.1e} px, {tracks.visible.mean():.0%} visible"
    )


def flow_errors(frame: Any, before: Any) -> np.ndarray:
    """Errors of flow [px] at pixels of skin, by rays against the triangles in doubles."""
    found = []
    camera, earlier = frame.camera, before.camera
    for id_, shape in frame.states.deformations.items():
        v, u = np.nonzero(frame["instance"] == id_)
        if len(v) < 50:
            continue
        picked = np.random.default_rng(id_).choice(len(v), min(len(v), 400), replace=False)
        v, u = v[picked], u[picked]
        now, then = deformed_model(shape), deformed_model(before.states.deformations[id_])
        own_now, own_then = (one.states.matrices[one.states.row(id_)] for one in (frame, before))
        rays = camera.intrinsics.rays()[v, u] @ camera.world_from_camera[:3, :3].T
        origin = own_now[:3, :3].T @ (camera.world_from_camera[:3, 3] - own_now[:3, 3])
        directions = rays @ own_now[:3, :3]
        triangle, weights = nearest_hits(now.corners, origin, directions)
        sure = (triangle >= 0) & (weights.min(axis=1) > 0.02)
        point = np.einsum("nk,nkj->nj", weights[sure], then.corners[triangle[sure]])
        world = point @ own_then[:3, :3].T + own_then[:3, 3]
        matrix = earlier.camera_from_world
        pixels = earlier.intrinsics.project(world @ matrix[:3, :3].T + matrix[:3, 3])
        expected = np.stack([u, v], axis=1)[sure] - pixels
        flow = frame["flow"][v[sure], u[sure]] * frame.dt_s
        depth = np.einsum("nk,nkj->nj", weights[sure], now.corners[triangle[sure]])
        seen = depth @ own_now[:3, :3].T + own_now[:3, 3]
        z = (seen - camera.world_from_camera[:3, 3]) @ camera.world_from_camera[:3, 2]
        same = np.abs(frame["depth"][v[sure], u[sure]] - z) < 1e-4
        found.append(np.abs(flow - expected)[same].max(axis=1))
    return np.concatenate([np.zeros(0), *found])


def nearest_hits(
    corners: np.ndarray, origin: np.ndarray, directions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the nearest triangle that faces each ray, and the weights of its corners."""
    first, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    q = np.cross(origin - first, ab)
    triangle, weights = np.full(len(directions), -1), np.zeros((len(directions), 3))
    for row, direction in enumerate(directions):
        p = np.cross(direction, ac)
        with np.errstate(all="ignore"):
            determinant = (p * ab).sum(axis=1)
            u = (p * (origin - first)).sum(axis=1) / determinant
            v = (q @ direction) / determinant
            t = (q * ac).sum(axis=1) / determinant
        met = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        if met.any():
            best = int(np.argmin(np.where(met, t, np.inf)))
            triangle[row], weights[row] = best, (1 - u[best] - v[best], u[best], v[best])
    return triangle, weights


def track_errors(tracks: Any, frames: Any) -> np.ndarray:
    """Errors of tracks [px]: the point's triangle at rest, found by brute force, in each frame."""
    errors = []
    for number, id_ in enumerate(tracks.instances.tolist()):
        shape = frames[0].states.deformations[id_]
        rest = np.concatenate(
            [part.mesh.positions[part.mesh.triangles] for part in shape.model.parts]
        ).astype(np.float64)
        triangle, weights = on_triangle(rest, tracks.coords[number])
        for place, frame in enumerate(frames[:: max(1, len(frames) // 20)]):
            place *= max(1, len(frames) // 20)
            now = frame.states.deformations[id_]
            corners = np.concatenate(
                [
                    mesh.positions[part.mesh.triangles]
                    for mesh, part in zip(now.meshes, now.model.parts, strict=True)
                ]
            )[triangle].astype(np.float64)
            own = frame.states.matrices[frame.states.row(id_)]
            world = own[:3, :3] @ (weights @ corners) + own[:3, 3]
            matrix = frame.camera.camera_from_world
            pixel = frame.camera.intrinsics.project(matrix[:3, :3] @ world + matrix[:3, 3])
            if tracks.in_view[number, place]:
                errors.append(np.abs(pixel - tracks.pixels[number, place]).max())
    return np.array(errors)


def on_triangle(corners: np.ndarray, point: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the triangle that a point lies on, and its weights."""
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    ap = point - a
    bb, bc, cc = (ab * ab).sum(1), (ab * ac).sum(1), (ac * ac).sum(1)
    d1, d2 = (ap * ab).sum(1), (ap * ac).sum(1)
    with np.errstate(all="ignore"):
        whole = bb * cc - bc * bc
        v, w = (cc * d1 - bc * d2) / whole, (bb * d2 - bc * d1) / whole
    inside = np.clip(np.stack([1 - v - w, v, w]), 0.0, None)
    inside /= inside.sum(axis=0)
    off = np.linalg.norm(
        inside[0, :, None] * a
        + inside[1, :, None] * (a + ab)
        + inside[2, :, None] * (a + ac)
        - point,
        axis=1,
    )
    best = int(np.nanargmin(off))
    return best, inside[:, best]


def clothes() -> None:
    """Skin that lies outside the clothes over it, standing, walking and sitting."""
    library = AssetLibrary(installed_sources())
    worst, shares = 0.0, []
    for name in people():
        asset = library.get(f"{name}_in_parts")
        rig = asset.rig
        assert rig is not None
        figure = figure_of(rig)
        stride = figure.stride
        feet = standing_feet(0.0, 0.0, 0.0, stride)
        way = way_along(feet, [(0.0, 0.0), (3.0, 0.0)], stride)
        worn = {
            place
            for part in asset.parts
            if part.name not in ("hair", "shoes")
            for place in part.meshes
        }
        outside, count = 0, 0
        for time_s in (0.0, 1.3 * stride.step_s, 1.8 * stride.step_s):
            frames = joint_frames(rig, walking_posture(rig, way.at(time_s), time_s))
            moved = skin_over(asset.model, rig, skin_matrices(rig, *frames)).meshes
            out_m = []
            for place in worn:
                part = asset.model.parts[place]
                if "skirt" in next(p.name for p in asset.parts if place in p.meshes):
                    continue
                cloth, normals = moved[place]
                for number in (0, 1):  # the skin of head and body
                    points = moved[number][0]
                    out_m.append(beyond(points, cloth, normals, part.mesh.triangles))
            found = np.concatenate([np.zeros(1), *out_m])
            worst = max(worst, float(found.max()))
            outside += int((found > 0.002).sum())
            count += sum(len(m[0]) for m in moved)
        shares.append(outside / count)
    print(
        f"clothes: {len(shares)} people, {max(shares):.2%} of the vertices at most, "
        f"{np.mean(shares):.2%} in the mean, lie more than 2 mm outside; "
        f"the farthest {1e3 * worst:.0f} mm"
    )


def beyond(
    points: np.ndarray, cloth: np.ndarray, normals: np.ndarray, triangles: np.ndarray
) -> np.ndarray:
    """How far points that a cloth covers lie outside of it [m]."""
    from scipy.spatial import cKDTree

    centres = cloth[triangles].mean(axis=1)
    facing = normals[triangles].mean(axis=1)
    away, near = cKDTree(centres).query(points, k=1, distance_upper_bound=0.012)
    some = np.isfinite(away)
    off = points[some] - centres[near[some]]
    return np.asarray(np.einsum("ij,ij->i", off, facing[near[some]]).clip(0.0, None))


def walks(rooms: int, count: int, names: tuple[str, ...]) -> None:
    """Tell of walks through generated rooms: arrivals, and how far limbs go into things."""
    library = SceneLibrary()
    kinds = ("living_room", "bedroom", "kitchen", "office")
    done = arrived = said = 0
    deepest, lowest, slid = [], [], []
    begun = time.time()
    for number in range(rooms):
        name = f"generated:{kinds[number % 4]}:{number}"
        text = library.path(name).read_text()
        with tempfile.TemporaryDirectory() as folder:
            world = library.build(scene_file(Path(folder), text))
            try:
                found = walks_in(world, number, count, names[number % len(names)])
            finally:
                world.close()
        for ok, problem, depth, low, slide in found:
            done += 1
            arrived += ok
            said += bool(problem) and not ok
            deepest.append(depth)
            lowest.append(low)
            slid.append(slide)
    print(
        f"walks: {done} in {rooms} rooms, {arrived} arrived, {said} said why not; "
        f"deepest in furniture {1e3 * max(deepest):.0f} mm, "
        f"over 20 mm in {np.mean(np.array(deepest) > DEEP_M):.1%}; "
        f"lowest sole {1e3 * min(lowest):.1f} mm; "
        f"most slide {1e3 * max(slid):.1f} mm; {time.time() - begun:.0f} s"
    )


DEEP_M = 0.02
"""Walks that go deeper into furniture are told one by one."""

STOCK = AssetLibrary(installed_sources())


def walks_in(world: World, seed: int, count: int, name: str) -> Any:
    """Yield (arrived, problem, depth, lowest sole, slide) of walks in one room."""
    from sailenv_ros.types.geometry import Pose
    from sailenv_ros.world.placement import Placement

    rng = np.random.default_rng(seed)
    asset = STOCK.get(name)
    category = world.contents.categories.named(asset.category).id
    id_ = world.spawn(Placement(name="walker", asset=asset, category_id=category, pose=Pose()))
    person = world.body(id_)
    assert isinstance(person, PersonBody)
    world.step(1)
    walker = person.walker
    client = world.client
    assert walker.crowd is not None
    space = walker.crowd.free_space(walker._size)
    free = np.argwhere(space.cells == FREE)
    if not len(free):
        return [(False, "there is no free place", 0.0, 0.0, 0.0)]
    person.put(Pose((*space.position_of(*free[rng.integers(len(free))].tolist())[:2], 0.0)))
    still = {
        body.bullet_id: body.placement.name
        for body in world.bodies
        if body is not person and body.collides
    }
    results = []
    for _ in range(count):
        goal = walker.random_place(rng)
        if goal is None or not walker.walk_to(goal):
            results.append((False, walker.problem or "no goal", 0.0, 0.0, 0.0))
            continue
        depth, met, low, slide, last = 0.0, "", 0.0, 0.0, None
        for _ in range(2000):
            world.step(8)
            for limb in person.limb_ids:
                for other in client.getOverlappingObjects(*client.getAABB(limb)) or ():
                    if other[0] in still:
                        for point in client.getClosestPoints(limb, other[0], 0.0):
                            if abs(point[7][2]) < 0.7 and -point[8] > depth:
                                depth, met = -point[8], still[other[0]]
            mesh = person.deformation().meshes
            soles = min(float(m.positions[:, 2].min()) for m in mesh)
            low = min(low, soles)
            moment = walker._moment()
            feet = np.array([[f.x, f.y] for f in moment.feet])
            if last is not None and last[1] == moment.swinging >= 0:
                moved = np.linalg.norm(feet - last[0], axis=1)
                slide = max(slide, float(np.delete(moved, moment.swinging).max()))
            last = (feet, moment.swinging)
            if walker.activity == "standing":
                break
        away = np.hypot(*(np.subtract(person.pose().position_m[:2], goal)))
        if depth > DEEP_M:
            print(f"room {seed}, {name}: {1e3 * depth:.0f} mm in {met}", flush=True)
        results.append((bool(away < 0.12), walker.problem, depth, low, slide))
    return results


def cost() -> None:
    """Compare a frame with three people with the same without them, at 640 × 480."""
    lens = CameraIntrinsics(width=640, height=480, vertical_fov_deg=60.0)
    eye = AgentSpec(name="eye", intrinsics=lens, following=False)
    spent = {}
    for count in (0, 3):
        with Simulation("room_02", mode="lockstep", agent=eye, light="plain") as simulation:
            simulation.set_pose(look_at((2.2, -1.6, 1.6), (-0.6, 0.4, 0.9)), teleport=True)
            for number in range(count):
                simulation.spawn_object(
                    f"person_{number + 1:02d}", position=(0.3 * number, -0.9 + 0.8 * number, 0.0)
                )
            times = []
            for _ in range(40):
                simulation.step(8)
                begun = time.process_time()  # of all threads: others may use the processor too
                frame = simulation.capture(["rgb", "depth", "category", "instance", "flow"])
                times.append(time.process_time() - begun)
            spent[count] = 1e3 * float(np.median(times[8:]))
            seen = int((frame["category"] == 45).sum())
    print(
        f"cost: {spent[0]:.1f} ms of processor time without, {spent[3]:.1f} ms with three people "
        f"({seen / frame['category'].size:.0%} of the pixels), {spent[3] / spent[0]:.2f} times"
    )


def coco() -> None:
    """Keypoints of a data set as pycocotools reads them, against themselves."""
    from pycocotools.coco import COCO
    from pycocotools.cocoeval import COCOeval

    from sailenv_ros.dataset.formats.coco import _keypoints
    from sailenv_ros.types.skeleton import COCO_KEYPOINTS

    annotations, images = [], []
    with tempfile.TemporaryDirectory() as folder:
        lens = CameraIntrinsics(width=640, height=480, vertical_fov_deg=60.0)
        eye = AgentSpec(name="eye", intrinsics=lens, following=False)
        with Simulation(scene_file(Path(folder)), mode="lockstep", agent=eye) as simulation:
            simulation.set_pose(look_at((2.7, -2.2, 1.7), (-0.3, 0.3, 0.9)), teleport=True)
            for image in range(1, 21):
                simulation.step(120)
                frame = simulation.capture(["depth", "instance"])
                images.append({"id": image, "width": 640, "height": 480})
                table = frame.objects
                assert frame.states is not None
                for id_ in frame.states.skeletons:
                    row = table.row(id_)
                    left, top, right, bottom = table.visible_boxes[row].tolist()
                    told = _keypoints(frame, id_)
                    if left >= 0 and told["num_keypoints"]:
                        box = [left, top, right - left + 1, bottom - top + 1]
                        annotations.append(
                            {"id": len(annotations) + 1, "image_id": image, "category_id": 1,
                             "bbox": box, "area": float(box[2] * box[3]), "iscrowd": 0, **told}
                        )  # fmt: skip
    category = {"id": 1, "name": "person", "keypoints": list(COCO_KEYPOINTS), "skeleton": []}
    with contextlib.redirect_stdout(io.StringIO()):
        truth = COCO()
        truth.dataset = {
            "images": images,
            "annotations": annotations,
            "categories": [category],
            "info": {},
        }
        truth.createIndex()
        results = [
            {"image_id": a["image_id"], "category_id": 1, "keypoints": a["keypoints"], "score": 1.0}
            for a in json.loads(json.dumps(annotations))
        ]
        judge = COCOeval(truth, truth.loadRes(results), "keypoints")
        judge.evaluate()
        judge.accumulate()
        judge.summarize()
    print(f"pycocotools: {len(annotations)} people, AP {judge.stats[0]:.3f}")


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("skin", "clothes", "walks", "cost", "coco"))
    parser.add_argument("--rooms", type=int, default=200)
    parser.add_argument("--walks", type=int, default=5)
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--animals", action="store_true", help="cats and dogs walk, not people")
    given = parser.parse_args()
    fetch_bodies()
    if given.what == "walks":
        walks(given.rooms, given.walks, tuple(animals() if given.animals else people()))
    elif given.what == "skin":
        skin_motion(given.frames)
    else:
        {"clothes": clothes, "cost": cost, "coco": coco}[given.what]()


if __name__ == "__main__":
    main()
