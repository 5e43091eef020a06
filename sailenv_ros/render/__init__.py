"""From a world snapshot to the views of one camera; the only place that imports moderngl."""
