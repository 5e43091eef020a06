"""Contacts to and from their messages."""

from __future__ import annotations

import sailenv_msgs.msg as msgs
from sailenv_msgs_py.stamps import ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import point_to_msg, vector_to_msg, xyz_from_msg
from sailenv_ros.contacts import Contact

__all__ = ["contact_from_msg", "contact_to_msg"]


def contact_to_msg(contact: Contact) -> msgs.Contact:
    """Make the message of a contact."""
    return msgs.Contact(
        stamp=stamp_from_ns(contact.sim_time_ns),
        first=contact.first,
        second=contact.second,
        mover=contact.mover,
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
        position_m=xyz_from_msg(message.position),
        normal=xyz_from_msg(message.normal),
        impulse_n_s=message.impulse_n_s,
        depth_m=message.depth_m,
        sim_time_ns=ns_from_stamp(message.stamp),
    )
