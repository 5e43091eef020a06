"""From a room's description and its daylight to what is seen behind its windows and doors."""

from __future__ import annotations

import importlib
import math
import random
from collections.abc import Iterable
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from sailenv_ros.assets.model_cache import cached_object
from sailenv_ros.assets.outside.atlas import MEAN_SHARE, model_parts
from sailenv_ros.assets.outside.corridor import add_corridor
from sailenv_ros.assets.outside.daylight import Daylight
from sailenv_ros.assets.outside.scenery import Scenery
from sailenv_ros.assets.outside.site import can_be_open, leads_out, site_of
from sailenv_ros.assets.rooms.room import RoomPart
from sailenv_ros.assets.rooms.wall_frames import Vector3, wall_frame
from sailenv_ros.scene.room_rules import WALLS
from sailenv_ros.scene.spec_outside import NO_OUTSIDE, OUTSIDE
from sailenv_ros.scene.spec_room import DoorSpec, OpeningSpec, RoomSpec, WindowSpec
from sailenv_ros.system.array_cache import code_digest
from sailenv_ros.system.memory import cached_for_scenes
from sailenv_ros.types.model import Asset, Model, ModelPart
from sailenv_ros.types.outside import Outside

__all__ = ["outside_asset", "outside_of"]

_CODE = ("assets", "assets/outside", "assets/outside/kinds", "assets/rooms", "scene", "types")
"""Folders of the code that shapes it."""

_CORRIDOR = 1.6
"""Radiance of white in a corridor, as shares of the mean outside by day; see `MEAN_SHARE`."""


def outside_asset(room: RoomSpec, daylight: Daylight) -> Asset | None:
    """Return what lies outside a room; the same object for an equal room while it is kept.

    Parameters
    ----------
    room : RoomSpec
    daylight : Daylight

    Returns
    -------
    asset : Asset or None
        In the world's axes. None if nothing is wanted or nothing of it could be seen.
    """
    if room.outside.kind == NO_OUTSIDE:
        return None
    seen = [o for o in room.openings if leads_out(o, room) or can_be_open(o)]
    # Looks of walls and of windows' frames change nothing.
    plain = RoomSpec(
        size=room.size,
        thickness=room.thickness,
        openings=tuple(seen),
        outside=room.outside,
    )
    return _made(plain, daylight) if seen else None


def outside_of(room: RoomSpec, parts: Iterable[RoomPart]) -> Outside:
    """Return through which openings of a room one looks out.

    Parameters
    ----------
    room : RoomSpec
    parts : iterable of RoomPart
        Those that it was built of.
    """
    half_x, half_y, height = room.size[0] / 2.0, room.size[1] / 2.0, room.size[2]
    names = {"floor", "ceiling", *(f"{wall} wall" for wall in WALLS)}
    shell = {
        part.asset.display_name: part.position_m
        for part in parts
        if part.asset.display_name in names
    }
    return Outside(
        low_m=(-half_x, -half_y, 0.0),
        high_m=(half_x, half_y, height),
        openings_m=tuple(_hole(room, opening) for opening in room.openings),
        shell=MappingProxyType(shell if len(shell) == len(names) else {}),
    )


def _hole(room: RoomSpec, opening: OpeningSpec) -> tuple[Vector3, Vector3]:
    frame = wall_frame(room, opening.wall)
    sill = opening.sill if isinstance(opening, WindowSpec) else 0.0
    half, foot = opening.width / 2.0, np.asarray(frame.middle_m)
    low = foot + frame.point(opening.at - half, 0.0, sill)
    high = foot + frame.point(opening.at + half, 0.0, sill + opening.height)
    (x0, y0, z0), (x1, y1, z1) = low.tolist(), high.tolist()
    return (x0, y0, z0), (x1, y1, z1)


@cached_for_scenes(4)
def _made(room: RoomSpec, daylight: Daylight) -> Asset:
    parts = cached_object(
        "outside",
        [room.model_dump_json(), daylight],
        lambda: _built(room, daylight),
        code=code_digest(*_CODE),
    )
    return Asset(
        name=OUTSIDE,
        display_name=OUTSIDE,
        category=OUTSIDE,
        model=Model(name=OUTSIDE, parts=parts),
        collision=(),
        tags=("room",),
    )


def _built(room: RoomSpec, daylight: Daylight) -> tuple[ModelPart, ...]:
    kind, seed, site = room.outside.kind, room.outside.seed, site_of(room)
    parts: list[ModelPart] = []
    if site.open_sides:
        scenery = Scenery(random.Random(f"{kind} {seed}"), site.turned_light(daylight))
        build = importlib.import_module(f"sailenv_ros.assets.outside.kinds.{kind}").build
        build(scenery, site)
        scenery.pieces[:] = [
            p
            for p in scenery.pieces
            if site.faced_by(p.origin, p.normal) and site.sees(p.places(np.asarray(p.outline)))
        ]
        # The nearest first: they hide most of the others, which cost little then.
        scenery.cards[:] = sorted(
            (c for c in scenery.cards if site.sees(np.asarray([c.centre]))),
            key=lambda card: math.hypot(*card.centre),
        )
        for part in model_parts(scenery, seed):
            mesh = part.mesh
            turned = replace(
                mesh,
                positions=site.turned_back(mesh.positions),
                normals=site.turned_back(mesh.normals),
            )
            parts.append(replace(part, mesh=turned))
    scale = max(parts[0].material.emission) if parts else None
    bright = MEAN_SHARE * (scale or 1.0)
    inside = Scenery(random.Random(seed), daylight)
    for opening in room.openings:
        if isinstance(opening, DoorSpec) and not leads_out(opening, room):
            add_corridor(inside, wall_frame(room, opening.wall), opening, _CORRIDOR * bright)
    if inside.pieces:
        parts += model_parts(inside, seed, scale)
    return tuple(parts)
