"""Bodies on joints: who carries whom, and who belongs together."""

from __future__ import annotations

from collections.abc import Iterator

from sailenv_ros.scene_export.contents import ExportedBody, ExportedScene

__all__ = ["carried", "together"]


def carried(scene: ExportedScene) -> dict[str, list[ExportedBody]]:
    """Return the bodies on the joints of each, by its name."""
    found: dict[str, list[ExportedBody]] = {}
    for body in scene.bodies:
        if body.joint is not None and body.joint.parent:
            found.setdefault(body.joint.parent, []).append(body)
    return found


def together(scene: ExportedScene) -> Iterator[tuple[str, str]]:
    """Yield the names of bodies that do not collide with each other.

    These are all on one tree of joints, and what carries them.
    """
    above = carried(scene)
    for root in scene.bodies:
        on_moving = root.joint is not None and _moves(scene, root.joint.parent)
        if root.joint is None or on_moving:
            continue
        group = [root.joint.parent] if root.joint.parent else []
        group.append(root.name)
        for name in group[-1:]:
            group += _all_above(above, name)
        yield from ((a, b) for place, a in enumerate(group) for b in group[place + 1 :])


def _moves(scene: ExportedScene, name: str) -> bool:
    return bool(name) and scene.by_name[name].joint is not None


def _all_above(above: dict[str, list[ExportedBody]], name: str) -> list[str]:
    own = [body.name for body in above.get(name, ())]
    return [*own, *(other for one in own for other in _all_above(above, one))]
