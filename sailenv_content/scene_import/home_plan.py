"""Home.xml of Sweet Home 3D → walls, rooms, pieces of furniture and cameras, in our axes and units.

The plan's y points down and its unit is the centimetre; its angles are clockwise from above. Here x
is east, y north, z up, in metres; yaws are counter-clockwise.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from sailenv_content.scene_import.home_types import (
    ARC_STEP,
    FRONT_YAW_DEG,
    Doubles,
    Home,
    HomeCamera,
    HomePiece,
    HomeRoom,
    HomeWall,
    Paint,
    Vector3,
)
from sailenv_content.scene_import.plan_walls import PlanWall
from sailenv_ros.assets.safe_xml import XmlNode
from sailenv_ros.errors import AssetError
from sailenv_ros.types.colour import linear_from_srgb

__all__ = ["read_home"]


_PIECES = ("pieceOfFurniture", "doorOrWindow", "light", "furnitureGroup", "shelfUnit")


@dataclass(frozen=True, slots=True)
class _Level:
    elevation_m: float
    rise_m: float
    visible: bool


def read_home(root: XmlNode) -> Home:
    """Read a home.

    Raises
    ------
    AssetError
        If it is none, or a number in it is none.
    """
    if root.tag != "home":
        raise AssetError(root.place, f"it must begin with <home>, and begins with <{root.tag}>")
    rise = _m(root, "wallHeight", 250.0)
    levels = {
        node.text("id"): _Level(
            _m(node, "elevation"), _m(node, "height", 100.0 * rise), node.flag("visible", True)
        )
        for node in root.all("level")
    }
    ground = _Level(0.0, rise, True)

    def level_of(node: XmlNode) -> _Level:
        return levels.get(node.text("level"), ground)

    def shown(*tags: str) -> Iterator[XmlNode]:
        return (node for node in root.all(*tags) if level_of(node).visible)

    walls = list(_walls(list(shown("wall")), level_of))
    pieces = [
        piece for node in shown(*_PIECES) for piece in _pieces(node, level_of(node).elevation_m)
    ]
    return Home(
        name=root.text("name").rpartition("/")[2].removesuffix(".sh3d"),
        walls=tuple(walls),
        rooms=tuple(_rooms(list(shown("room")), level_of)),
        pieces=tuple(pieces),
        cameras=tuple(_camera(node) for node in root.all("observerCamera", "camera")),
    )


def _walls(nodes: list[XmlNode], level_of: Callable[[XmlNode], _Level]) -> Iterator[HomeWall]:
    made: dict[str, list[PlanWall]] = {}
    painted = []
    for node in nodes:
        level = level_of(node)
        points = _wall_points(node)
        rise = _m(node, "height", 100.0 * level.rise_m)
        ends = rise, _m(node, "heightAtEnd", 100.0 * rise)
        steps = np.linspace(0.0, 1.0, len(points))
        tops = [(1.0 - s) * ends[0] + s * ends[1] for s in steps]
        lines = [
            PlanWall(
                start=points[k],
                end=points[k + 1],
                thickness_m=_m(node, "thickness", 7.5),
                low_m=level.elevation_m,
                rise_m=(tops[k], tops[k + 1]),
            )
            for k in range(len(points) - 1)
        ]
        for first, second in itertools.pairwise(lines):
            first.after, second.before = second, first
        made[node.text("id")] = lines
        paint = [_paint(node, side) for side in ("leftSide", "rightSide", "top")]
        painted.append((node, lines, paint))
    for node, lines, _ in painted:
        # Its own side of each joint; the other wall tells by its ends which one it is.
        for end, name in ((0, "wallAtStart"), (-1, "wallAtEnd")):
            others = made.get(node.text(name))
            if others:
                mine = lines[end].start if end == 0 else lines[end].end
                near = min(
                    (others[0], others[-1]),
                    key=lambda line: min(
                        np.linalg.norm(line.start - mine), np.linalg.norm(line.end - mine)
                    ),
                )
                if end == 0:
                    lines[0].before = near
                else:
                    lines[-1].after = near
    for _, lines, (left, right, top) in painted:
        # Left is that of who walks along the wall as it is drawn, which is the same here.
        yield from (HomeWall(line=line, left=left, right=right, top=top) for line in lines)


def _wall_points(node: XmlNode) -> list[Doubles]:
    start = np.array([_m(node, "xStart"), -_m(node, "yStart")])
    end = np.array([_m(node, "xEnd"), -_m(node, "yEnd")])
    arc = node.number("arcExtent", 0.0, most=2.0 * math.pi)
    chord = float(np.linalg.norm(end - start))
    if abs(arc) < 1e-3 or chord < 1e-6:
        return [start, end]
    # In the plan, positive arcs bulge so that they turn clockwise as drawn; y is turned over here.
    half = 0.5 * arc
    x, y = (end - start) / chord
    to_centre = 0.5 * chord / math.tan(half)
    centre = 0.5 * (start + end) + to_centre * np.array([-y, x]) * -1.0
    steps = max(2, math.ceil(abs(arc) / ARC_STEP))
    from_centre = start - centre
    points = []
    for k in range(steps + 1):
        turn = -arc * k / steps
        c, s = math.cos(turn), math.sin(turn)
        points.append(centre + np.array([[c, -s], [s, c]]) @ from_centre)
    points[0], points[-1] = start, end
    return points


def _rooms(nodes: list[XmlNode], level_of: Callable[[XmlNode], _Level]) -> Iterator[HomeRoom]:
    for number, node in enumerate(nodes, 1):
        level = level_of(node)
        points = [(_m(p, "x"), -_m(p, "y")) for p in node.all("point")]
        if len(points) < 3:
            continue
        yield HomeRoom(
            name=node.text("name") or f"room {number}",
            outline=np.array(points),
            elevation_m=level.elevation_m,
            level_rise_m=level.rise_m,
            floor=_paint(node, "floor") if node.flag("floorVisible", True) else None,
            ceiling=_paint(node, "ceiling") if node.flag("ceilingVisible", True) else None,
        )


def _pieces(node: XmlNode, elevation_m: float) -> Iterator[HomePiece]:
    if not node.flag("visible", True):
        return
    if node.tag == "furnitureGroup":
        for child in node.all(*_PIECES):
            yield from _pieces(child, elevation_m)
        return
    turn = node.numbers("modelRotation", 9)
    kinds = {"doorOrWindow": "opening", "light": "light"}
    size = tuple(max(_m(node, key), 1e-4) for key in ("depth", "width", "height"))
    x, y = _m(node, "x"), -_m(node, "y")
    z = elevation_m + _m(node, "elevation")
    yaw = FRONT_YAW_DEG - math.degrees(node.number("angle", most=1e4))
    yield HomePiece(
        kind=kinds.get(node.tag, "piece"),
        catalogue=node.text("catalogId"),
        name=node.text("name") or node.tag,
        creator=node.text("creator"),
        licence=node.text("license"),
        model=node.text("model"),
        position=(x, y, z),
        yaw_deg=math.remainder(yaw, 360.0),
        tilt_deg=(
            math.degrees(node.number("roll", most=1e4)),
            math.degrees(node.number("pitch", most=1e4)),
        ),
        size_m=(size[0], size[1], size[2]),
        turn=np.eye(3) if turn is None else np.array(turn).reshape(3, 3),
        mirrored=node.flag("modelMirrored"),
        paint=_paint(node, ""),
        materials={
            material.text("name"): _paint(material, "")
            for material in node.all("material")
            if material.text("name")
        },
        sources=tuple(_sources(node, (x, y, z), yaw, (size[0], size[1], size[2]))),
        cut=(
            node.number("wallLeft", 0.0, most=10.0),
            node.number("wallTop", 0.0, most=10.0),
            node.number("wallWidth", 1.0, most=10.0),
            node.number("wallHeight", 1.0, most=10.0),
        ),
    )


def _sources(
    node: XmlNode, base: Vector3, yaw_deg: float, size: Vector3
) -> Iterator[tuple[Vector3, Vector3]]:
    """Yield place and colour of the light sources; their x, y, z are shares of the piece's size.

    x counts from its left as drawn, y from its front to its back.
    """
    power = min(max(node.number("power", 0.5, most=1e3), 0.0), 1.0)
    depth, width, height = size
    a = math.radians(yaw_deg)
    front, beside = np.array([math.cos(a), math.sin(a)]), np.array([-math.sin(a), math.cos(a)])
    for source in node.all("lightSource"):
        x, y, z = (source.number(key, 0.5, most=100.0) for key in "xyz")
        place = np.array(base[:2]) + beside * width * (x - 0.5) + front * depth * (0.5 - y)
        colour = _colour(source, "color") or (1.0, 1.0, 1.0)
        red, green, blue = (4.0 * power * part for part in colour)
        yield (float(place[0]), float(place[1]), base[2] + height * z), (red, green, blue)


def _camera(node: XmlNode) -> HomeCamera:
    return HomeCamera(
        name=node.text("name") or node.text("attribute") or "camera",
        position=(_m(node, "x"), -_m(node, "y"), _m(node, "z", 170.0)),
        pitch_deg=math.degrees(node.number("pitch", most=10.0)),
        yaw_deg=math.remainder(FRONT_YAW_DEG - math.degrees(node.number("yaw", most=1e4)), 360.0),
        fov_deg=math.degrees(node.number("fieldOfView", 1.1, most=math.pi)),
        is_observer=node.text("attribute") == "observerCamera",
    )


def _paint(node: XmlNode, prefix: str) -> Paint:
    colour = _colour(node, f"{prefix}Color" if prefix else "color")
    wanted = f"{prefix}Texture" if prefix else ""
    texture = next(
        (t for t in node.all("texture") if not wanted or t.text("attribute") == wanted), None
    )
    shininess = node.number(f"{prefix}Shininess" if prefix else "shininess", 0.0, most=1e3)
    shininess = min(max(shininess, 0.0), 1.0)
    if texture is None:
        return Paint(colour=colour, shininess=shininess)
    scale = max(texture.number("scale", 1.0, most=1e4), 1e-3)
    tile = tuple(max(_m(texture, key, 100.0) * scale, 0.01) for key in ("width", "height"))
    return Paint(
        image=texture.text("image"), tile_m=(tile[0], tile[1]), shininess=shininess, colour=None
    )


def _colour(node: XmlNode, name: str) -> Vector3 | None:
    """Return a colour as written (AARRGGBB or RRGGBB) in linear light; None if there is none."""
    given = node.text(name)
    if not given:
        return None
    try:
        number = int(given, 16)
    except ValueError:
        raise AssetError(
            node.place, f"{name} of <{node.tag}> must be a colour like 00A0B0C0, got {given[:20]!r}"
        ) from None
    rgb = np.array([(number >> shift) & 0xFF for shift in (16, 8, 0)]) / 255.0
    red, green, blue = linear_from_srgb(rgb).tolist()
    return red, green, blue


def _m(node: XmlNode, name: str, default_cm: float = 0.0) -> float:
    return node.number(name, default_cm, most=1e6) / 100.0
