"""Answers recomputed from MJCF by MuJoCo, and from COCO's masks: the judge of `judge_language`."""

from __future__ import annotations

import json
import math
import re
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from pycocotools import mask as rle
from scipy import ndimage

from benchmarks.mujoco_room import CELL_M, Room, hull_of, outside

NEAR_M = 0.5
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


class Picture:
    """One picture: what its masks show, and where its camera was."""

    def __init__(self, room: Room, camera: str, notes: list[dict[str, Any]]) -> None:
        self.room = room
        number = room.m.camera(camera).id
        self.eye = room.d.cam_xpos[number].copy()
        self.forward = -room.d.cam_xmat[number].reshape(3, 3)[:, 2]
        self.of: dict[int, list[dict[str, Any]]] = defaultdict(list)
        for one in notes:
            whole = room.whole(one["instance_id"])
            if room.category.get(whole, "outside") not in NO_THINGS:
                self.of[whole].append(one)

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
        seen: float = sum(one["area"] for one in self.of[id_])
        return 1.0 - seen / float(whole)

    def ways(self, id_: int, radius: float) -> tuple[np.ndarray, np.ndarray, tuple[int, int]]:
        """Free cells reached from below the camera, their distances from an object; the start."""
        free, corner = self.room.space(radius)
        at = tuple(((self.eye[:2] - corner) / CELL_M).astype(int))
        regions, _ = ndimage.label(free)
        grid = np.stack(np.meshgrid(*(np.arange(n) for n in free.shape), indexing="ij"), -1)
        middle, turn, size, _ = self.room.box(id_)
        signs = np.array(np.meshgrid(*([-0.5, 0.5],) * 3)).reshape(3, -1).T
        flat = hull_of((middle + (signs * size) @ turn.T)[:, :2])
        off = outside(corner + (grid + 0.5) * CELL_M, flat)
        return np.where(regions == regions[at], off, np.inf) if free[at] else off + np.inf, free, at


def agrees(one: dict[str, Any], now: Picture, before: Picture | None, meant: dict[str, int]) -> Any:
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
        middle = room.box(ids[0])[0]
        if kind == "distance":
            length = now.away(ids[0])
        elif kind == "height":
            length = room.height(ids[0])
        else:
            other = before.room.box(ids[0]) if before and kind == "travel" else room.box(ids[-1])
            length = float(np.linalg.norm(middle - other[0]))
        return abs(length - number) <= step
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
        rows.append(number[a][both])
        columns.append(number[b][both])
        lengths.append(np.full(int(both.sum()), math.hypot(dx, dy)))
    graph = coo_matrix((np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns))),
                       (free.size, free.size)).tocsr()  # fmt: skip
    found = dijkstra(graph, directed=False, indices=[number[one] for one in starts], min_only=True)
    return np.asarray(found.reshape(free.shape))


def true_of(text: str, now: Picture) -> list[int] | None:
    """Return the visible objects that an expression is true of; None for what is not judged."""
    names = {category for category in now.room.category.values() if category not in NO_THINGS}
    patterns: tuple[tuple[str, Any], ...] = (
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
                return list(meant(own, now.like(found["y"])))
            return list(meant(own)) if own else []
    return None


def judge(folder: Path, most: int, part: int, parts: int) -> None:
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
        if int(image["model"].split("_")[0]) % parts != part:
            continue
        if image["model"] not in rooms:
            prefix = image["model"].split("_")[0]
            rooms = {name: room for name, room in rooms.items() if name.startswith(f"{prefix}_")}
            rooms[image["model"]] = Room(folder / image["model"], parents[prefix])
        now = Picture(rooms[image["model"]], image["camera"], notes[number])
        before = pictures[-1] if pictures else None
        pictures = [now]
        meant = {one["text"]: one["object"] for one in lines["all_referring"][number]}
        for text, id_ in meant.items():
            meets = true_of(text, now)
            told += meets is not None
            once += meets == [id_]
            if meets is not None and meets != [id_]:
                print("expression", number, text, id_, meets)
        for one in lines["all"][number]:
            answers[one["kind"]][one["answer"]] += 1
            if one["kind"] == "colour" or sum(asked.values()) >= most:
                continue
            asked[one["kind"]] += 1
            fine = agrees(one, now, before, meant)
            same[one["kind"]] += bool(fine)
            if not fine:
                print(
                    "answer", number, image, one["kind"], one["text"], one["answer"], one["objects"]
                )
    print("|kind|answers|agree|commonest|chance|\n|---|---|---|---|---|")
    for kind, counts in sorted(answers.items()):
        total = sum(counts.values())
        chance = 0.5 if kind in ("nearer", "taller") else 1.0 / len(counts)
        print(
            f"|{kind}|{total}|{same[kind]} of {asked[kind]}|{max(counts.values()) / total:.3f}"
            f"|{chance:.3f}|"
        )
    print(f"{sum(same.values())} of {sum(asked.values())} answers agree; "
          f"{once} of {told} expressions are true of one object")  # fmt: skip
