"""Motion between any two frames, in the picture and in space; see `docs/motion.md`."""

from sailenv_ros.frame.motion.between import Motion, motion
from sailenv_ros.frame.motion.forward import FORWARD_VIEWS, forward_views, with_forward_motion
from sailenv_ros.frame.motion.object_coordinates import object_coordinates
from sailenv_ros.frame.motion.tracks import ObjectPoints, Tracks, track
from sailenv_ros.rays.scene_geometry import SceneGeometry

__all__ = [
    "FORWARD_VIEWS",
    "Motion",
    "ObjectPoints",
    "SceneGeometry",
    "Tracks",
    "forward_views",
    "motion",
    "object_coordinates",
    "track",
    "with_forward_motion",
]
