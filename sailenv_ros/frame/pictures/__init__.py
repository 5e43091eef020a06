"""Views of a frame as pictures for people; arrays in, arrays and PNG files out. Knows no ROS."""

from sailenv_ros.frame.pictures.colours import (
    colour_categories,
    colour_depth,
    colour_flow,
    grey_depth,
    view_picture,
)
from sailenv_ros.frame.pictures.contact_sheet import contact_sheet, save_contact_sheet

__all__ = [
    "colour_categories",
    "colour_depth",
    "colour_flow",
    "contact_sheet",
    "grey_depth",
    "save_contact_sheet",
    "view_picture",
]
