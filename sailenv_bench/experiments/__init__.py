"""The paper's experiments on this simulator: flow, detection, throughput, and their report.

Measures through the same doors as users: `Simulation`, `Agent`, the gateway. Results are JSON files
in one folder, from which plots and a report are made.
"""
