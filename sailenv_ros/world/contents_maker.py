"""Contents of a world apart from poses, as renderers and clients receive them.

Bodies, lights and surroundings in, `SceneContents` out, under a new revision at each change.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.labels import PART_MARK, CategoryTable, Instance, Keypoint
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.snapshot import DrawnInstance, SceneContents
from sailenv_ros.world.body_table import BodyTable
from sailenv_ros.world.labelled_pieces import LabelledPiece
from sailenv_ros.world.lit_lamps import is_lamp, lit_by
from sailenv_ros.world.placement import Placement

__all__ = ["ContentsMaker"]


class ContentsMaker:
    """Makes the contents of one world.

    Parameters
    ----------
    scene : str
    epoch : int
    categories : CategoryTable
    lights : tuple of Light
    environment : Environment
    bodies : BodyTable
    described : callable
        Returns what a scene file says of it all now; None where there is none.
    next_revision : callable
        Gives a larger number at each call.

    Attributes
    ----------
    lights : tuple of Light
    environment : Environment
    baked : BakedLight or None
        Light that was computed beforehand; these three count from `renew` on.
    """

    def __init__(
        self,
        *,
        scene: str,
        epoch: int,
        categories: CategoryTable,
        lights: tuple[Light, ...],
        environment: Environment,
        bodies: BodyTable,
        described: Callable[[], SceneSpec | None],
        next_revision: Callable[[], int],
    ) -> None:
        self.lights = lights
        self.environment = environment
        self.baked: BakedLight | None = None
        self._scene = scene
        self._epoch = epoch
        self._categories = categories
        self._bodies = bodies
        self._described = described
        self._next_revision = next_revision
        self._lit_by: Mapping[int, tuple[str, ...]] = {}
        self._lamps_of: tuple[object, ...] | None = None
        self._current: SceneContents | None = None
        self.renew()

    @property
    def current(self) -> SceneContents:
        """The contents now: the same object until something of them is changed."""
        if self._current is None:
            self._current = self._made()
        return self._current

    def renew(self) -> None:
        """Count a change of something of them; they are made again when they are asked for."""
        self._revision, self._current, self._lamps_of = self._next_revision(), None, None

    def forget_charts(self, ids: Collection[int]) -> None:
        """Take the baked light off instances whose surfaces are others now."""
        if self.baked is not None:
            charts = {id_: c for id_, c in self.baked.charts.items() if id_ not in ids}
            self.baked = replace(self.baked, charts=charts, checksum="")

    def light_lamps(self, poses: NDArray[np.float64]) -> None:
        """Find the lights that are in lamps now, some of which may have been moved."""
        pieces = self._bodies.pieces
        rows = [row for row, piece in enumerate(pieces) if is_lamp(piece)]
        lamps = [(pieces[row].body_id, pieces[row].body.placement) for row in rows]
        key = lamps, self.lights, poses[rows].tobytes()
        if self._lamps_of == key:
            return
        self._lamps_of = key
        found = lit_by(pieces, poses, self.lights)
        if found != self._lit_by:
            self._lit_by = found
            drawn = tuple(self.drawn(piece) for piece in self._bodies.pieces)
            self._current = replace(self.current, instances=drawn)

    def _made(self) -> SceneContents:
        pieces = self._bodies.pieces
        self._lit_by = lit_by(pieces, self._bodies.world_from_body(), self.lights)
        return SceneContents(
            scene=self._scene,
            epoch=self._epoch,
            revision=self._revision,
            instances=tuple(self.drawn(piece) for piece in pieces),
            categories=self._categories,
            lights=self.lights,
            environment=self.environment,
            baked=self.baked,
        )

    def _parent_of(self, placement: Placement) -> int:
        """Return the id of the object that one is a part of; 0 if there is none (any more)."""
        name = "" if placement.entry is None else placement.entry.part_of
        if not name and placement.joint is not None:
            name = placement.joint.parent
        return self._bodies.id_of_name(name) if name else 0

    def drawn(self, piece: LabelledPiece) -> DrawnInstance:
        """Return what is drawn of a body or a part of one."""
        placement = piece.body.placement
        asset, part, category_id = placement.asset, piece.part, placement.category_id
        model, name, parent = asset.body_model, asset.name, self._parent_of(placement)
        keypoints = asset.keypoints
        if part is not None:
            model, name, parent = (
                asset.part_model(part),
                f"{name}{PART_MARK}{part.name}",
                piece.body_id,
            )
            category_id, keypoints = self._categories.named(part.category).id, ()
        low, high = model.bounds().tolist()
        instance = Instance(
            id=piece.id,
            name=piece.name,
            asset=name,
            category_id=category_id,
            category=self._categories[category_id].name,
            static=piece.body.placement.static,
            low_m=_scaled(low, placement.scale),
            high_m=_scaled(high, placement.scale),
            parent=parent,
            materials=_material_names(placement) if part is None else (),
            painted=_painted(placement, self._described()) if part is None else "",
            keypoints=tuple(
                Keypoint(name=point, position_m=_scaled(place, placement.scale))
                for point, place in keypoints
            ),
        )
        return DrawnInstance(
            instance=instance,
            model=model,
            scale=placement.scale,
            lit_by=self._lit_by.get(piece.body_id, ()),
            stands=placement.outside is None and (placement.static or _stays(placement)),
            outside=placement.outside,
            deforms=asset.rig is not None,
        )


def _stays(placement: Placement) -> bool:
    """Return whether what is on a joint has light of its own: not what opens of a piece."""
    on_joint = placement.joint is not None and not placement.behaviours
    return on_joint and not placement.asset.opens


def _material_names(placement: Placement) -> tuple[str, ...]:
    """Return the names of an object's own materials; none of a part of a room."""
    if placement.entry is None:
        return ()
    return placement.materials


def _painted(placement: Placement, described: SceneSpec | None) -> str:
    """Return as JSON what a scene file says of an object's materials; empty for the asset's own."""
    if placement.entry is not None:
        entries = [m.model_dump(mode="json", exclude_unset=True) for m in placement.entry.materials]
        return json.dumps(entries, sort_keys=True) if entries else ""
    look = None if described is None else described.room and described.room.look_of(placement.name)
    return "" if not look else json.dumps([look], sort_keys=True)


def _scaled(point: Sequence[float], scale: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (float(a) * float(b) for a, b in zip(point, scale, strict=True))
    return x, y, z
