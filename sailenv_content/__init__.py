"""Content: the standard pack and how it is built, generated rooms, imported scenes."""
