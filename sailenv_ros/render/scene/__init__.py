"""Scene data that both renderers draw from: meshes, materials, lamps, baked light."""
