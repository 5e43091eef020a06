"""Scenes of other programs → scene files with their packs.

A file in, an `ImportedScene` from the importer of its kind, a pack and a scene file out;
`importers.import_scene` does all of it. Nothing is imported here, because the process that reads
URDF and MJCF begins with this package.
"""
