"""The renderer for processors: no graphics library, no driver, the same bytes everywhere."""
