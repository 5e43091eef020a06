"""News of the object that one client has selected: told when it was chosen and when it changes.

Hints that something may have changed in, messages out; what is as it was told last is not told
again. Nothing is asked of the simulation without a hint.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable

from sailenv_ros.errors import InvalidRequest, SailenvError
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.joints import JointState
from sailenv_ros.viewer.edit_history import Conversation
from sailenv_ros.viewer.messages import JointValues, ObjectMessage
from sailenv_ros.viewer.scene_json import object_to_json

__all__ = ["PAUSE_S", "SelectedObject", "joint_of"]

PAUSE_S = 0.1
"""Least time between two messages, for sliders are fast [s]."""

ENDLESS = {"hinge": math.pi, "slide": 1.0}
"""Range of a slider to both sides for a joint without limits [rad], [m]."""


class SelectedObject:
    """The selection of one client; made in the event loop.

    Parameters
    ----------
    context : Conversation
        Asked for the object.
    send : callable
        Sends a message.
    """

    def __init__(
        self, context: Conversation, send: Callable[[ObjectMessage], Awaitable[None]]
    ) -> None:
        self._context = context
        self._send = send
        self._id = 0
        self._told: ObjectMessage | None = None
        self._hint = asyncio.Event()

    @property
    def id(self) -> int:
        """Instance id; 0 for none."""
        return self._id

    def choose(self, instance_id: int) -> None:
        """Select another object, or none with 0; it is told in any case."""
        self._id = instance_id
        self._told = None
        self.changed()

    def changed(self) -> None:
        """Have the object looked at, as it may have changed."""
        self._hint.set()

    async def tell(self) -> None:
        """Send it, now and again, until this is cancelled."""
        while True:
            await self._hint.wait()
            self._hint.clear()
            if self._id == 0:
                continue
            try:
                message = await self._message(self._id)
            except SailenvError:
                continue  # the scene is loading, or the simulation ends
            if message["id"] == self._id and message != self._told:
                self._told = message
                await self._send(message)
            await asyncio.sleep(PAUSE_S)

    async def _message(self, number: int) -> ObjectMessage:
        try:
            state = await self._context.run(Operations.get_object, number)
        except InvalidRequest:
            return {"type": "object", "id": number, "object": None, "joint": None}
        joint = await joint_of(self._context, number)
        return {"type": "object", "id": number, "object": object_to_json(state), "joint": joint}


async def joint_of(context: Conversation, number: int) -> JointValues | None:
    """Return the joint that an object moves on; None where it has none that moves."""
    joints = await context.run(Operations.get_joints)
    return next((_joint_to_json(joint) for joint in joints if joint.id == number), None)


def _joint_to_json(joint: JointState) -> JointValues:
    reach = ENDLESS[joint.type]
    return {
        "type": joint.type,
        "position": joint.position,
        "low": joint.low if math.isfinite(joint.low) else joint.position - reach,
        "high": joint.high if math.isfinite(joint.high) else joint.position + reach,
    }
