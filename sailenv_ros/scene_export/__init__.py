"""Scenes and objects as files of other programs: `exporting` does it, one writer a format."""

from sailenv_ros.scene_export.exporting import ExportReport, export_asset, export_scene

__all__ = ["ExportReport", "export_asset", "export_scene"]
