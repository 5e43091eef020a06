"""Rays against the triangles of scenes: one gatherer, one tree, one rule for cut-outs."""
