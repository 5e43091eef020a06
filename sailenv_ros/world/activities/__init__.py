"""What people do where their way ends: one activity a file."""
