"""Which renderer draws, and the one that needs no OpenGL."""
