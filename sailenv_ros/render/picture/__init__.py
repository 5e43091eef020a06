"""From radiance, depth and ids to the views: annotation, smooth edges, tone."""
