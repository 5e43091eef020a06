"""Scenes and objects as files of other programs: `exporting` does it, one writer a format."""

from sailenv_ros.scene_export.exporting import ExportReport, export_asset, export_scene
from sailenv_ros.scene_export.formats import SCENE_FORMATS

__all__ = ["SCENE_FORMATS", "ExportReport", "export_asset", "export_scene"]
