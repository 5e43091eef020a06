"""Camera placement: poses chosen by rules and seeds.

A rule is one file here: settings, and a function that chooses; `rule_table` names them all.
"""

from sailenv_ros.authoring.viewpoints.rule_table import camera_rules, sample_cameras
from sailenv_ros.authoring.viewpoints.view_scene import CameraView, ViewScene

__all__ = ["CameraView", "ViewScene", "camera_rules", "sample_cameras"]
