"""Edits of the running scene: journal, undo, saving."""
