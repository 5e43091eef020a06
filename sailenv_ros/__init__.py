"""A virtual visual environment: furnished, simulated rooms with exact per-pixel ground truth."""

__version__ = "0.1.0"
