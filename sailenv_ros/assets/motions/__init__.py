"""Recorded motion of people: files of several formats → `types.motion_clip.MotionClip`."""

from sailenv_ros.assets.motions.clip_files import add_motion, clip_names, find_clip, read_clip

__all__ = ["add_motion", "clip_names", "find_clip", "read_clip"]
