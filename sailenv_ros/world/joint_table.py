"""Assemblies of objects on joints: bodies in, one tree of the engine for each assembly."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.joint_tree import JointTree
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.kinematics import composed

__all__ = ["JointTable"]


class JointTable:
    """The trees of a world.

    Parameters
    ----------
    client : BulletClient
    """

    def __init__(self, client: BulletClient) -> None:
        self._client = client
        self._trees: dict[tuple[JointedBody, ...], JointTree] = {}

    @property
    def trees(self) -> tuple[JointTree, ...]:
        """All of them, in the order of their first objects."""
        return tuple(self._trees.values())

    def arrange(self, bodies: Iterable[Body]) -> None:
        """Have a tree for all that hangs together; joints keep their positions and speeds.

        Parameters
        ----------
        bodies : iterable of Body
            All of the world.

        Raises
        ------
        UnknownName
            If an object is joined to what is not there.
        InvalidRequest
            If it is joined to what moves freely, or to itself, also by others; all is as it was
            then.
        """
        everything = list(bodies)
        by_name = {body.placement.name: body for body in everything}
        parents = {
            body: _parent(body, by_name) for body in everything if isinstance(body, JointedBody)
        }
        groups = list(_groups(parents))
        wanted: dict[tuple[JointedBody, ...], JointTree] = {}
        made: list[JointTree] = []
        try:
            for group in groups:
                tree = self._trees.get(group)
                if tree is None:
                    places = {body: place for place, body in enumerate(group)}
                    links = [body.as_link(_place(parents[body], places)) for body in group]
                    tree = JointTree(self._client, links, _rest(group[0], parents[group[0]]))
                    made.append(tree)
                wanted[group] = tree
        except BaseException:
            for tree in made:
                tree.remove()
            raise
        for group, tree in self._trees.items():
            if group not in wanted:
                tree.remove()
        self._trees = wanted
        for group, tree in wanted.items():
            for number, body in enumerate(group):
                body.hang(tree, number, parents[body])
            carrier = parents[group[0]]
            if carrier is not None:
                tree.ignore(carrier.bullet_id)

    def carried_by(self, body: Body) -> tuple[JointedBody, ...]:
        """Return the objects whose joints are on one."""
        return tuple(one for group in self._trees for one in group if one.parent is body)

    def require_nothing_on(self, body: Body, what: str) -> None:
        """Refuse a body that carries another on a joint; `what` ends "object …" in the error.

        Raises
        ------
        InvalidRequest
        """
        carried = self.carried_by(body)
        if carried:
            one = carried[0].placement.name
            accepted = f"one that carries nothing on a joint; this one carries {one!r}"
            raise InvalidRequest(f"object {what}", body.placement.name, accepted)

    def above(self, body: Body) -> tuple[JointedBody, ...]:
        """Return all objects that go where one goes: those on it, those on these, and so on."""
        found: list[JointedBody] = []
        waiting = [body]
        while waiting:
            carried = self.carried_by(waiting.pop())
            found += carried
            waiting += carried
        return tuple(found)

    def follow(self, body: Body) -> None:
        """Take along what is joined to a body that was put elsewhere."""
        for group, tree in self._trees.items():
            if group[0].parent is body:
                tree.put(group[0].rest_pose())

    def before_step(self) -> None:
        """Leave joints that nobody drives any more to their friction."""
        for tree in self._trees.values():
            if tree.is_driven:
                tree.before_step()

    def after_step(self) -> bool:
        """Hold joints within their limits; tell if any has moved."""
        moved = False
        for tree in self._trees.values():
            moved |= tree.after_step()
        return moved


def _parent(body: JointedBody, by_name: Mapping[str, Body]) -> Body | None:
    name, own = body.joint.parent, body.placement.name
    if not name:
        return None
    if name not in by_name:
        raise UnknownName(f"parent of the joint of {own!r}", name, by_name)
    parent = by_name[name]
    if not parent.placement.static and not isinstance(parent, JointedBody):
        accepted = "an object that is static or has a joint itself"
        raise InvalidRequest(f"parent of the joint of {own!r}", name, accepted)
    return parent


def _groups(parents: Mapping[JointedBody, Body | None]) -> Iterator[tuple[JointedBody, ...]]:
    """Yield what hangs together, each followed by all that it carries: the engine's own order.

    It numbers links so, whatever the order in which it is told of them.
    """
    carried: dict[Body | None, list[JointedBody]] = {}
    for body, parent in parents.items():
        carried.setdefault(parent, []).append(body)
    found: set[JointedBody] = set()
    for root, parent in parents.items():
        if isinstance(parent, JointedBody):
            continue
        group: list[JointedBody] = []
        waiting = [root]
        while waiting:
            body = waiting.pop()
            group.append(body)
            waiting += reversed(carried.get(body, []))
        found.update(group)
        yield tuple(group)
    for body in parents:
        if body not in found:
            name = body.placement.name
            accepted = "another object than one that it carries"
            raise InvalidRequest(f"parent of the joint of {name!r}", body.joint.parent, accepted)


def _place(parent: Body | None, places: Mapping[JointedBody, int]) -> int:
    return places[parent] if isinstance(parent, JointedBody) else -1


def _rest(root: JointedBody, parent: Body | None) -> Pose:
    if root.is_free:
        return root.rest_pose()
    rest = root.joint.parent_from_rest
    return rest if parent is None else composed(parent.pose(), rest)
