"""Kinds of surroundings: a module each, whose name is the kind's and whose `build` makes it."""
