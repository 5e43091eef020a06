"""Light of a scene: baked beforehand, and kept right while objects move."""
