"""Measuring sailenv_ros: the experiments of the paper, through the same doors as users."""
