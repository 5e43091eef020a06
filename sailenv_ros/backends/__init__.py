"""Which renderer draws."""
