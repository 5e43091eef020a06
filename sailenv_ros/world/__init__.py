"""The live physics state of a scene; the only place that imports PyBullet."""
