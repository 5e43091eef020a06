"""Filters of entities: names, categories, tags and regions."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from simulation_interfaces.msg import Bounds, EntityCategory, Result, TagsFilter

from sailenv_msgs_py.space_msgs import triples_from_msg
from sailenv_msgs_py.transforms import vector_to_msg
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk, Told
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal, unsupported
from sailenv_ros.simulation.operations.entity_operations import EntityOperations
from sailenv_ros.space.outlines import Solid
from sailenv_ros.space.solid_distances import MOST_CORNERS
from sailenv_ros.system.posix_regex import PosixRegex
from sailenv_ros.types.entities import Entity

__all__ = ["CATEGORIES", "box_to_bounds", "chosen_entities", "tags_filter", "told_of"]

Vector3 = tuple[float, float, float]

CATEGORIES = frozenset(
    getattr(EntityCategory, name) for name in dir(EntityCategory) if name.startswith("CATEGORY_")
)

HUMAN = "person"
"""Name of the category of people."""


def told_of(desk: Desk, entity: Entity) -> Told:
    """Return what a client has set of an entity, else what follows from what it is."""
    told = desk.notes.told.get(entity.id)
    if told is not None:
        return told
    if entity.id < 0:
        category = EntityCategory.CATEGORY_ROBOT
    elif entity.category == HUMAN:
        category = EntityCategory.CATEGORY_HUMAN
    elif entity.static:
        category = EntityCategory.CATEGORY_STATIC_OBJECT
    elif entity.moving:
        category = EntityCategory.CATEGORY_DYNAMIC_OBJECT
    else:
        category = EntityCategory.CATEGORY_OBJECT
    tags = (entity.category, entity.asset, *(("spawned",) if entity.added else ()))
    return Told(int(category), f"{entity.category}: {entity.asset}", tags)


async def chosen_entities(desk: Desk, filters: Any) -> list[Entity]:
    """Return the entities that pass all filters, at one instant.

    Raises
    ------
    Refusal, InvalidRequest
        If a filter is none.
    """
    named = PosixRegex(filters.filter)
    tagged = tags_filter(filters.tags)
    categories = {one.category for one in filters.categories}
    region = region_of(filters.bounds)
    found = await desk.do(EntityOperations.entities, region)
    return [
        entity
        for entity in found
        if named.found_in(desk.name_of(entity))
        and (not categories or told_of(desk, entity).category in categories)
        and tagged(told_of(desk, entity).tags)
    ]


def tags_filter(wanted: Any) -> Callable[[Iterable[str]], bool]:
    """Return whether tags pass a `TagsFilter`; without tags everything passes."""
    modes = {TagsFilter.FILTER_MODE_ANY: any, TagsFilter.FILTER_MODE_ALL: all}
    if wanted.filter_mode not in modes:
        raise Refusal(
            Result.RESULT_OPERATION_FAILED,
            f"filter_mode must be 0 (any) or 1 (all), got {wanted.filter_mode}",
        )
    if not wanted.tags:
        return lambda tags: True
    mode = modes[wanted.filter_mode]
    return lambda tags: mode(tag in tuple(tags) for tag in wanted.tags)


def region_of(bounds: Any) -> Solid | None:
    """Return the region of `Bounds` in the world; None if they are empty."""
    if bounds.type == Bounds.TYPE_EMPTY:
        return None
    points = triples_from_msg(bounds.points)
    few = {Bounds.TYPE_SPHERE: 2, Bounds.TYPE_BOX: 2, Bounds.TYPE_CONVEX_HULL: 3}
    if bounds.type not in few:
        raise unsupported(f"bounds of type {bounds.type} are none of empty, box, hull and sphere")
    most = MOST_CORNERS if bounds.type == Bounds.TYPE_CONVEX_HULL else 2
    if not few[bounds.type] <= len(points) <= most or not np.isfinite(points).all():
        raise Refusal(
            Result.RESULT_OPERATION_FAILED,
            f"bounds must have two finite points, or 3 to {MOST_CORNERS} of a convex hull",
        )
    if bounds.type == Bounds.TYPE_SPHERE:
        if points[1, 0] < 0.0:
            raise Refusal(Result.RESULT_OPERATION_FAILED, "a sphere's radius must not be negative")
        return Solid(points[:1], float(points[1, 0]))
    if bounds.type == Bounds.TYPE_BOX:
        corners = np.stack([points.min(axis=0), points.max(axis=0)])
        return Solid(np.array(list(itertools.product(*corners.T))))
    return Solid(points)


def box_to_bounds(low_m: Vector3, high_m: Vector3) -> Any:
    """Make bounds of a box: the upper corner first."""
    return Bounds(type=Bounds.TYPE_BOX, points=[vector_to_msg(high_m), vector_to_msg(low_m)])
