"""Making scenes: generated rooms, imported scenes, rules for cameras."""
