"""Making scenes: generated rooms, rules for cameras."""
