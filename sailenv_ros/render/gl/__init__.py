"""The OpenGL renderer; the only package that imports moderngl."""
