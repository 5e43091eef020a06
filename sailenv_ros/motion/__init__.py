"""Motion between any two frames, in the picture and in space; see `docs/motion.md`."""

from sailenv_ros.motion.between import Motion, motion
from sailenv_ros.motion.forward import FORWARD_VIEWS, forward_views, with_forward_motion

__all__ = ["FORWARD_VIEWS", "Motion", "forward_views", "motion", "with_forward_motion"]
