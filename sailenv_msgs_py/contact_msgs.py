"""Contacts to and from their messages."""

from __future__ import annotations

from collections.abc import Sequence

from std_msgs.msg import Header

import sailenv_msgs.msg as msgs
from sailenv_msgs_py.frame_info import WORLD_FRAME_ID
from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import point_to_msg, vector_to_msg, xyz_from_msg
from sailenv_ros.types.contacts import Contact

__all__ = ["contact_from_msg", "contact_to_msg", "contacts_to_msg"]


def contact_to_msg(contact: Contact) -> msgs.Contact:
    """Make the message of a contact."""
    return msgs.Contact(
        stamp=stamp_from_ns(contact.sim_time_ns),
        first=contact.first,
        second=contact.second,
        mover=contact.mover,
        other_mover=contact.other_mover,
        position=point_to_msg(contact.position_m),
        normal=vector_to_msg(contact.normal),
        impulse_n_s=contact.impulse_n_s,
        depth_m=contact.depth_m,
    )


def contact_from_msg(message: msgs.Contact) -> Contact:
    """Read the message of a contact."""
    return Contact(
        first=message.first,
        second=message.second,
        mover=message.mover,
        other_mover=message.other_mover,
        position_m=xyz_from_msg(message.position),
        normal=xyz_from_msg(message.normal),
        impulse_n_s=message.impulse_n_s,
        depth_m=message.depth_m,
        sim_time_ns=ns_from_stamp(message.stamp),
    )


def contacts_to_msg(
    contacts: Sequence[Contact], *, sim_time_ns: int, revision: int
) -> msgs.Contacts:
    """Make the message of all contacts up to an instant [ns]."""
    return msgs.Contacts(
        header=Header(stamp=stamp_from_ns(sim_time_ns), frame_id=WORLD_FRAME_ID),
        revision=revision,
        contacts=[contact_to_msg(contact) for contact in contacts],
    )
