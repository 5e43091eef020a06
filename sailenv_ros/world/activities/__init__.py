"""Activities of people where their way ends: one a file."""
