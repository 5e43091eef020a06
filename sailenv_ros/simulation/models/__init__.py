"""What the catalogue of assets is shown and filled with: thumbnails and uploaded models."""
