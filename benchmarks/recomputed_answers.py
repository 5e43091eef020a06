"""Answers recomputed from MJCF by MuJoCo, and from COCO's masks: the judge of `judge_language`."""

from __future__ import annotations

import json
import math
import re
from collections import Counter, defaultdict
from functools import cache
from pathlib import Path
from typing import Any

import mujoco as mj
import numpy as np
from pycocotools import mask as rle
from scipy import ndimage

NEAR_M, CELL_M = 0.5, 0.05
WORDS = {"wood": "oak|walnut|beech|birch|teak|cherry|ash|pine|wenge|mahogany", "fabric": "fabric",
         "metal": "chrome|steel|brass|copper|bronze|alu", "leather": "leather", "glass": "glass"}  # fmt: skip
NO_THINGS = set(
    [
        "wall",
        "floor",
        "ceiling",
        "skirting",
        "window",
        "door",
        "curtain",
        "outside",
        "plane",
        "unlabelled",
    ]
)


class Room:
    """One model at its exported instant."""

    def __init__(self, path: Path, parents: dict[int, int]) -> None:
        self.parents = parents
        self.m = mj.MjModel.from_xml_path(str(path))
        self.d = mj.MjData(self.m)
        mj.mj_resetDataKeyframe(self.m, self.d, 0) if self.m.nkey else None
        mj.mj_forward(self.m, self.d)
        user = self.m.geom_user[:, 0].astype(int)
        self.geoms = {g: defaultdict(list) for g in (2, 3)}
        for geom, (id_, group) in enumerate(zip(user, self.m.geom_group, strict=True)):
            self.geoms[group][id_].append(geom)
        self.body = {id_: int(self.m.geom_bodyid[own[0]])
                     for group in (3, 2) for id_, own in self.geoms[group].items()}  # fmt: skip

        names = {f"category {c}": bytes(self.m.text_data[a:a + n - 1]).decode()
                 for c in range(1 << 9) for k in [mj.mj_name2id(self.m, mj.mjtObj.mjOBJ_TEXT, f"category {c}")]
                 if k >= 0 for a, n in [(self.m.text_adr[k], self.m.text_size[k])]}  # fmt: skip
        self.category = {
            int(i): names[f"category {int(c)}"] for i, c in self.m.geom_user[:, :2] if i
        }

    @cache  # noqa: B019 - one room at a time
    def whole(self, id_: int) -> int:
        """The object that something is a part of: by its mask, or by what carries its body."""
        if self.parents.get(id_):
            return self.whole(self.parents[id_])
        if id_ in self.body and self.m.body_parentid[self.body[id_]] > 0:
            above = int(self.m.body_parentid[self.body[id_]])
            return self.whole(min(i for i, body in self.body.items() if body == above))
        return id_

    def all(self, id_: int) -> list[int]:
        """An object with its parts."""
        return [i for i in self.body if self.whole(i) == id_]

    def height(self, id_: int) -> float:
        """From its lowest to its highest point."""
        return float(np.ptp(self.box(id_)[3][:, 2]))

    def is_on(self, id_: int, carriers: list[int]) -> bool:
        """Whether it touches one of several things, whose top is at its bottom."""
        return any(abs(self.box(id_)[3][0, 2] - self.box(c)[3][1, 2]) <= 0.05
                   and self.gap(self.all(id_), self.all(c)) <= 0.035 for c in carriers)  # fmt: skip

    def moved(self, before: Room, id_: int) -> bool:
        """Whether it went by more than 1 cm or turned by more than 3 degrees."""
        (a, turn, *_), (b, other, *_) = before.box(id_), self.box(id_)
        angle = math.degrees(math.acos(np.clip((np.trace(turn.T @ other) - 1) / 2, -1, 1)))
        return bool(np.linalg.norm(b - a) > 0.01 or angle > 3.0)

    def opened(self, id_: int) -> float:
        """Greatest share of their ways that its joints are open."""
        shares = [0.0]
        for j in range(self.m.njnt):
            owner = next(i for i, b in self.body.items() if b == self.m.jnt_bodyid[j])
            if self.whole(owner) == id_ and self.m.jnt_type[j] != mj.mjtJoint.mjJNT_FREE:
                far = max(self.m.jnt_range[j], key=abs)
                shares.append(float(self.d.qpos[self.m.jnt_qposadr[j]] / far))
        return max(shares)

    def material(self, id_: int) -> str:
        """Word for the material of most of its surface, by the name of that."""
        areas: Counter[str] = Counter()
        for g in (g for i in self.all(id_) for g in self.geoms[2][i]):
            k, name = self.m.geom_dataid[g], self.m.material(self.m.geom_matid[g]).name
            first, count = self.m.mesh_faceadr[k], self.m.mesh_facenum[k]
            own = self.m.mesh_vert[self.m.mesh_vertadr[k] :][
                self.m.mesh_face[first : first + count]
            ]
            area = np.linalg.norm(np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]), axis=1)
            word = next((w for w, names in WORDS.items()
                         if re.match(rf"(light_|black_)?({names})(_|$)", name)), "")  # fmt: skip
            areas[word] += float(area.sum())
        return areas.most_common(1)[0][0]

    def points(self, id_: int) -> np.ndarray:
        """Corners of what is drawn of an object, in the world."""
        found = []
        for g in self.geoms[2][id_]:
            begin = self.m.mesh_vertadr[k := self.m.geom_dataid[g]]
            own = self.m.mesh_vert[begin : begin + self.m.mesh_vertnum[k]]
            found.append(own @ self.d.geom_xmat[g].reshape(3, 3).T + self.d.geom_xpos[g])
        return np.concatenate(found)

    @cache  # noqa: B019 - one room at a time
    def box(self, id_: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Middle, axes and size of its box; lowest and highest point."""
        turn = self.d.xmat[self.body[id_]].reshape(3, 3)
        world = self.points(id_)
        own = world @ turn
        low, high = own.min(0), own.max(0)
        return turn @ (low + high) / 2, turn, high - low, np.array([world.min(0), world.max(0)])

    def gap(self, a: list[int], b: list[int]) -> float:
        """Shortest distance between collision shapes of two lists of objects."""
        return min((mj.mj_geomDistance(self.m, self.d, g, h, 0.2, None)
                    for i in a for j in b for g in self.geoms[3][i] for h in self.geoms[3][j]),
                   default=0.2)  # fmt: skip

    def meets(self, start: np.ndarray, ray: np.ndarray, ids: list[int]) -> bool:
        """Whether a ray meets collision shapes of an object, or begins in one."""
        for g in (g for i in ids for g in self.geoms[3][i]):
            kind, pos, mat = self.m.geom_type[g], self.d.geom_xpos[g], self.d.geom_xmat[g]
            if kind == mj.mjtGeom.mjGEOM_MESH:
                if mj.mj_rayMesh(self.m, self.d, g, start, ray, None) >= 0:
                    return True
            elif mj.mju_rayGeom(pos, mat, self.m.geom_size[g], start, ray, kind, None) >= 0:
                return True
        return False

    @cache  # noqa: B019 - one room at a time
    def space(self, radius: float) -> tuple[np.ndarray, np.ndarray]:
        """Cells in which an upright cylinder touches nothing and is above a floor; their corner."""
        solid = [g for own in self.geoms[3].values() for g in own]
        ends = np.array([self._ends(g) for g in solid])
        low, high = ends[:, 0, :2].min(0), ends[:, 1, :2].max(0)
        shape = np.ceil((high - low) / CELL_M).astype(int) + 1
        hit, floor = np.zeros(shape, bool), np.zeros(shape, bool)
        grid = np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), -1)
        middles = low + (grid + 0.5) * CELL_M
        for g, (a, b) in zip(solid, ends, strict=True):
            if a[2] >= 1.0 or b[2] < -0.3:
                continue
            window = tuple(
                slice(max(int((a[k] - low[k] - radius) / CELL_M) - 1, 0),
                      int((b[k] - low[k] + radius) / CELL_M) + 2) for k in (0, 1))  # fmt: skip
            away = _outside(middles[window], self._outline(g))
            if b[2] > 0.05:
                hit[window] |= away < radius
            else:
                floor[window] |= away <= 0.0
        return floor & ~hit, low

    def _ends(self, g: int) -> np.ndarray:
        corners = self._corners(g)
        return np.array([corners.min(0), corners.max(0)])

    def _corners(self, g: int) -> np.ndarray:
        kind, size = self.m.geom_type[g], self.m.geom_size[g]
        if kind == mj.mjtGeom.mjGEOM_MESH:
            begin = self.m.mesh_vertadr[k := self.m.geom_dataid[g]]
            own = self.m.mesh_vert[begin : begin + self.m.mesh_vertnum[k]]
        else:
            turns = np.linspace(0, 2 * np.pi, 64)
            ring = np.stack([np.cos(turns), np.sin(turns)], -1)
            if kind == mj.mjtGeom.mjGEOM_BOX:
                own = np.array(np.meshgrid(*([-s, s] for s in size))).reshape(3, -1).T
            elif kind == mj.mjtGeom.mjGEOM_CYLINDER:
                own = np.array([[*(size[0] * r), z] for r in ring for z in (-size[1], size[1])])
            else:
                lat = np.linspace(-np.pi / 2, np.pi / 2, 17)
                own = size[0] * np.array(
                    [[*(np.cos(t) * r), np.sin(t)] for t in lat for r in ring])  # fmt: skip
        return own @ self.d.geom_xmat[g].reshape(3, 3).T + self.d.geom_xpos[g]

    def _outline(self, g: int) -> np.ndarray:
        """Hull of what of a shape lies between the robot's step and its top, seen from above."""
        points = self._corners(g)
        z0, z1 = (0.05, 1.0) if points[:, 2].max() > 0.05 else (-9.0, 9.0)
        inside = points[(points[:, 2] >= z0) & (points[:, 2] <= z1)]
        cut = []
        for z in (z0, z1):
            below, above = points[points[:, 2] < z], points[points[:, 2] > z]
            if len(below) and len(above):
                t = (z - below[:, None, 2]) / (above[None, :, 2] - below[:, None, 2])
                cut.append(
                    (below[:, None] + t[..., None] * (above - below[:, None])).reshape(-1, 3)
                )
        return _hull(np.concatenate([inside, *cut])[:, :2])


def _hull(points: np.ndarray) -> np.ndarray:
    points = np.unique(points.round(6), axis=0)
    chains = []
    for order in (points, points[::-1]):
        chain: list[np.ndarray] = []
        for p in order:
            while len(chain) > 1 and np.cross(chain[-1] - chain[-2], p - chain[-2]) <= 0:
                chain.pop()
            chain.append(p)
        chains += chain[:-1]
    return np.array(chains) if chains else points


def _outside(at: np.ndarray, hull: np.ndarray) -> np.ndarray:
    """Distances of points from a convex polygon; 0 inside."""
    a, b = hull, np.roll(hull, -1, 0)
    edge = b - a
    off = at[..., None, :] - a
    t = np.clip((off * edge).sum(-1) / np.maximum((edge**2).sum(-1), 1e-12), 0, 1)
    gap = np.linalg.norm(off - t[..., None] * edge, axis=-1).min(-1)
    inside = (edge[:, 0] * off[..., 1] - edge[:, 1] * off[..., 0] >= 0).all(-1)
    return np.where(inside & (len(hull) > 2), 0.0, gap)


class Picture:
    """One picture: what its masks show, and where its camera was."""

    def __init__(self, room: Room, camera: str, notes: list[dict[str, Any]]) -> None:
        self.room = room
        number = room.m.camera(camera).id
        self.eye = room.d.cam_xpos[number].copy()
        self.forward = -room.d.cam_xmat[number].reshape(3, 3)[:, 2]
        self.of: dict[int, list[dict[str, Any]]] = defaultdict(list)
        for one in notes:
            if room.category.get(one["instance_id"], "outside") not in NO_THINGS:
                self.of[room.whole(one["instance_id"])].append(one)

    def like(self, category: str) -> list[int]:
        """Visible objects of a category."""
        return [id_ for id_ in self.of if self.room.category.get(id_) == category]

    def span(self, id_: int) -> tuple[int, int]:
        """Leftmost and rightmost column that it is seen in."""
        boxes = [one["bbox"] for one in self.of[id_]]
        return min(b[0] for b in boxes), max(b[0] + b[2] - 1 for b in boxes)

    def away(self, id_: int) -> float:
        """Distance from the camera to its middle."""
        return float(np.linalg.norm(self.room.box(id_)[0] - self.eye))

    def hidden(self, id_: int) -> float:
        """Share of its mask that other things cover."""
        whole = rle.area(rle.merge([one["amodal_segmentation"] for one in self.of[id_]]))
        return 1.0 - sum(one["area"] for one in self.of[id_]) / float(whole)

    def ways(self, id_: int, radius: float) -> tuple[np.ndarray, np.ndarray, tuple[int, int]]:
        """Free cells reached from below the camera, their distances from an object; the start."""
        free, corner = self.room.space(radius)
        at = tuple(((self.eye[:2] - corner) / CELL_M).astype(int))
        regions, _ = ndimage.label(free)
        grid = np.stack(np.meshgrid(*(np.arange(n) for n in free.shape), indexing="ij"), -1)
        middle, turn, size, _ = self.room.box(id_)
        signs = np.array(np.meshgrid(*([-0.5, 0.5],) * 3)).reshape(3, -1).T
        flat = _hull((middle + (signs * size) @ turn.T)[:, :2])
        off = _outside(corner + (grid + 0.5) * CELL_M, flat)
        return np.where(regions == regions[at], off, np.inf) if free[at] else off + np.inf, free, at


def agrees(
    one: dict[str, Any], now: Picture, before: Picture | None, meant: dict[str, int]
) -> bool:
    """Return whether an answer is found again."""
    kind, answer, ids, room = one["kind"], one["answer"], one["objects"], now.room
    number = float((re.match(r"[\d.]+", answer) or (math.nan,))[0])
    step = 0.5 * 10.0 ** -len(answer.split(" ")[0].partition(".")[2]) + 0.002
    if kind == "existence":
        category = re.sub(r"^(Is there|Do you see|Can) an? | (in the picture|be seen)?\?$|\?$", "",
                          one["text"])  # fmt: skip
        return (answer == "yes") == bool(now.like(category))
    if kind == "count":
        return int(answer) == len(now.like(room.category[ids[0]]))
    if kind in ("distance", "height", "apart", "travel"):
        length = {"distance": lambda: now.away(ids[0]), "height": lambda: np.ptp(room.box(ids[0])[3][:, 2]),
                  "apart": lambda: np.linalg.norm(room.box(ids[0])[0] - room.box(ids[1])[0]),
                  "travel": lambda: np.linalg.norm(room.box(ids[0])[0] - before.room.box(ids[0])[0])}  # type: ignore[union-attr]  # fmt: skip
        return abs(float(length[kind]()) - number) <= step
    if kind in ("nearer", "taller"):
        measure = now.away if kind == "nearer" else lambda i: -np.ptp(room.box(i)[3][:, 2])
        return meant[answer] == min(ids, key=measure) and {meant[answer]} <= set(ids)
    if kind == "side":
        first, second = now.span(ids[0]), now.span(ids[1])
        return first[1] < second[0] if answer == "left" else second[1] < first[0]
    if kind == "side_from":
        middle, turn = room.box(ids[1])[:2]
        return ((room.box(ids[0])[0] - middle) @ turn)[1] > 0 if answer == "left" else (
            (room.box(ids[0])[0] - middle) @ turn)[1] < 0  # fmt: skip
    if kind == "support":
        near = room.gap(room.all(ids[0]), room.all(ids[1])) <= 0.035
        level = abs(room.box(ids[0])[3][0, 2] - room.box(ids[1])[3][1, 2]) <= 0.035
        return meant[answer] == ids[1] and near and level
    if kind == "inside":
        middle, turn = room.box(ids[0])[0], room.box(ids[1])[1]
        hit = [room.meets(middle, ray, room.all(ids[1])) for ray in (*turn.T, *-turn.T)]
        return meant[answer] == ids[1] and sum(hit) >= 5
    if kind == "touch":
        gap = room.gap(room.all(ids[0]), room.all(ids[1]))
        return gap <= 0.007 if answer == "yes" else gap >= 0.018
    if kind == "hidden":
        return abs(100.0 * now.hidden(ids[0]) - number) <= 5.0
    if kind == "open":
        return (room.opened(ids[0]) > 0.05) == (answer == "open")
    if kind == "material":
        return room.material(ids[0]) == answer
    if kind in ("reach", "path"):
        width = float(re.search(r"([\d.]+) m wide", one["text"])[1])  # type: ignore[index]
        off, free, at = now.ways(ids[0], 0.5 * width)
        if kind == "reach":
            return (off.min() <= NEAR_M + 0.05) if answer == "yes" else off.min() > 0.7
        return answer in _begins(off, free, at, now.forward)
    assert before is not None
    if kind == "moved":
        return room.moved(before.room, ids[0]) == (answer == "yes")
    both = {id_ for id_ in now.of if id_ in before.of and room.moved(before.room, id_)}
    said = {meant[name] for name in re.split(r", | and (?=the )", answer)}
    return kind == "change" and said == set(ids) == both


def _begins(
    off: np.ndarray, free: np.ndarray, at: tuple[int, int], forward: np.ndarray
) -> set[str]:
    """Directions in which shortest ways to the cells near an object begin."""
    goals = np.argwhere(off <= NEAR_M + 0.05)
    from_start = _distances(free, [at])
    goals = goals[from_start[tuple(goals.T)] <= from_start[tuple(goals.T)].min() + 0.15 / CELL_M]
    back = _distances(free, [tuple(goal) for goal in goals])
    leg = np.argwhere((from_start >= 0.28 / CELL_M) & (from_start <= 0.4 / CELL_M))
    sums = from_start[tuple(leg.T)] + back[tuple(leg.T)]
    best = leg[sums <= sums.min() + 2.0] - np.array(at)
    turn = np.degrees(np.arctan2(best[:, 1], best[:, 0]) - math.atan2(forward[1], forward[0]))
    words = {"ahead": 0, "left": 90, "backwards": 180, "right": -90}
    return {word for word, middle in words.items()
            if (np.abs((turn - middle + 180) % 360 - 180) <= 45).any()}  # fmt: skip


def _distances(free: np.ndarray, starts: list[tuple[int, int]]) -> np.ndarray:
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import dijkstra

    number = np.arange(free.size).reshape(free.shape)
    rows, columns, lengths = [], [], []
    for dx, dy in ((1, 0), (0, 1), (1, 1), (1, -1)):
        a = (slice(0, -dx or None), slice(max(-dy, 0), -dy if dy > 0 else None))
        b = (slice(dx, None), slice(max(dy, 0), dy if dy < 0 else None))
        both = free[a] & free[b]
        rows.append(number[a][both]), columns.append(number[b][both])
        lengths.append(np.full(int(both.sum()), math.hypot(dx, dy)))
    graph = coo_matrix((np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns))),
                       (free.size, free.size)).tocsr()  # fmt: skip
    found = dijkstra(graph, directed=False, indices=[number[one] for one in starts], min_only=True)
    return found.reshape(free.shape)


def true_of(text: str, now: Picture) -> list[int] | None:
    """Return the visible objects that an expression is true of; None for what is not judged."""
    names = {category for category in now.room.category.values() if category not in NO_THINGS}
    patterns = (
        (r"the (?P<x>.+) nearest to the camera", lambda ids: [min(ids, key=now.away)]),
        (r"the tallest (?P<x>.+)", lambda ids: [max(ids, key=now.room.height)]),
        (r"the leftmost (?P<x>.+)", lambda ids: [min(ids, key=lambda i: now.span(i)[0])]),
        (r"the rightmost (?P<x>.+)", lambda ids: [max(ids, key=lambda i: now.span(i)[1])]),
        (
            r"the (?P<x>.+) on the (?P<y>.+)",
            lambda ids, y: [i for i in ids if now.room.is_on(i, y)],
        ),
        (r"the (?P<x>.+)", lambda ids: ids),
    )
    for pattern, meant in patterns:
        found = re.fullmatch(pattern, text)
        if found and set(found.groupdict().values()) <= names:
            own = now.like(found["x"])
            if "y" in found.groupdict():
                return list(meant(own, now.like(found["y"])))  # type: ignore[operator]
            return list(meant(own)) if own else []  # type: ignore[operator]
    return None


def judge(folder: Path, most: int) -> None:
    """Print a row for each kind of question, of so many answers, and one of all expressions."""
    coco = json.loads((folder / "data/coco/annotations.json").read_text())
    images = json.loads((folder / "images.json").read_text())
    notes = defaultdict(list)
    for one in coco["annotations"]:
        notes[one["image_id"]].append(one)
    parents: dict[str, dict[int, int]] = defaultdict(dict)
    for number, image in enumerate(images):
        for one in notes[number]:
            parents[image["model"].split("_")[0]][one["instance_id"]] = one["parent_id"]
    lines = {name: defaultdict(list) for name in ("all", "all_referring")}
    for name, found in lines.items():
        for line in (folder / f"data/vqa/{name}.jsonl").read_text().splitlines():
            found[int(json.loads(line)["image"][7:13])].append(json.loads(line))
    same, asked, answers = Counter(), Counter(), defaultdict(Counter)
    rooms: dict[str, Room] = {}
    pictures: list[Picture] = []
    told = once = 0
    for number, image in enumerate(images):
        if image["model"] not in rooms:
            prefix = image["model"].split("_")[0]
            rooms = {name: room for name, room in rooms.items() if name.startswith(f"{prefix}_")}
            rooms[image["model"]] = Room(folder / image["model"], parents[prefix])
        now = Picture(rooms[image["model"]], image["camera"], notes[number])
        before = pictures[-1] if pictures else None
        pictures = [now]
        meant = {one["text"]: one["object"] for one in lines["all_referring"][number]}
        for text, id_ in meant.items():
            found = true_of(text, now)
            told += found is not None
            once += found == [id_]
            if found is not None and found != [id_]:
                print("expression", number, text, id_, found)
        for one in lines["all"][number]:
            answers[one["kind"]][one["answer"]] += 1
            if one["kind"] == "colour" or sum(asked.values()) >= most:
                continue
            asked[one["kind"]] += 1
            fine = agrees(one, now, before, meant)
            same[one["kind"]] += fine
            if not fine:
                print(
                    "answer", number, image, one["kind"], one["text"], one["answer"], one["objects"]
                )
    print("|kind|answers|agree|commonest|chance|\n|---|---|---|---|---|")
    for kind, counts in sorted(answers.items()):
        total = sum(counts.values())
        chance = 0.5 if kind in ("nearer", "taller") else 1.0 / len(counts)
        print(
            f"|{kind}|{total}|{same[kind]} of {asked[kind]}|{max(counts.values()) / total:.3f}|{chance:.3f}|"
        )
    print(f"{sum(same.values())} of {sum(asked.values())} answers agree; "
          f"{once} of {told} expressions are true of one object")  # fmt: skip
