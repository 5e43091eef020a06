"""Contents of the asset catalogue: thumbnails and uploaded models."""
