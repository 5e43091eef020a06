"""What a scene draws at random: distributions, things to draw, and drawing, without physics."""
