"""Frames: the views of one camera at one instant, and all that can be asked of them."""
