"""Where to put cameras: poses chosen by rules and seeds.

A rule is one file here: settings, and a function that chooses; `registry` names them all.
"""

from sailenv_ros.viewpoints.base import CameraView, ViewScene
from sailenv_ros.viewpoints.registry import camera_rules, sample_cameras

__all__ = ["CameraView", "ViewScene", "camera_rules", "sample_cameras"]
