"""Kinds of drift, one a file: settings of a course in, a change of a `StreamState` out."""
