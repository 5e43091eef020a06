"""Scenes of other programs → scene files with their packs.

A file in, an `ImportedScene` from the importer of its kind, a pack and a scene file out.
"""

from sailenv_ros.scene_import.importers import IMPORTED_SUFFIXES, ImportReport, import_scene

__all__ = ["IMPORTED_SUFFIXES", "ImportReport", "import_scene"]
