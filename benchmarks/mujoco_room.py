"""An exported room as MuJoCo knows it, for `recomputed_answers`: boxes, gaps, rays, free floor."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

import mujoco as mj
import numpy as np

CELL_M = 0.05
WORDS = {
    "wood": "oak|walnut|beech|birch|teak|cherry|ash|pine|wenge|mahogany",
    "fabric": "fabric",
    "metal": "chrome|steel|brass|copper|bronze|alu",
    "leather": "leather",
    "glass": "glass",
}


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

        names = {}
        for number in range(self.m.ntext):
            begin, size = self.m.text_adr[number], self.m.text_size[number]
            text = bytes(self.m.text_data[begin : begin + size - 1]).decode()
            names[mj.mj_id2name(self.m, mj.mjtObj.mjOBJ_TEXT, number)] = text
        self.category = {
            int(i): names[f"category {int(c)}"] for i, c in self.m.geom_user[:, :2] if i
        }

    @cache  # noqa: B019 - one room at a time
    def whole(self, id_: int) -> int:
        """Return what something is a part of: by its mask, or by what carries its body."""
        if self.parents.get(id_):
            return self.whole(self.parents[id_])
        if id_ in self.body and self.m.body_parentid[self.body[id_]] > 0:
            above = int(self.m.body_parentid[self.body[id_]])
            return self.whole(min(i for i, body in self.body.items() if body == above))
        return id_

    def all(self, id_: int) -> list[int]:
        """Return an object with its parts."""
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
        areas: dict[str, float] = defaultdict(float)
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
        return max(areas, key=lambda word: areas[word])

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
            away = outside(middles[window], self._outline(g))
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
        return np.asarray(own @ self.d.geom_xmat[g].reshape(3, 3).T + self.d.geom_xpos[g])

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
        return hull_of(np.concatenate([inside, *cut])[:, :2])


def hull_of(points: np.ndarray) -> np.ndarray:
    """Return the convex hull of points of a plane, counter-clockwise."""
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


def outside(at: np.ndarray, hull: np.ndarray) -> np.ndarray:
    """Distances of points from a convex polygon; 0 inside."""
    a, b = hull, np.roll(hull, -1, 0)
    edge = b - a
    off = at[..., None, :] - a
    t = np.clip((off * edge).sum(-1) / np.maximum((edge**2).sum(-1), 1e-12), 0, 1)
    gap = np.linalg.norm(off - t[..., None] * edge, axis=-1).min(-1)
    inside = (edge[:, 0] * off[..., 1] - edge[:, 1] * off[..., 0] >= 0).all(-1)
    return np.where(inside & (len(hull) > 2), 0.0, gap)
