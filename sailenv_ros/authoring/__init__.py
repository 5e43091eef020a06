"""Rules by which scenes are made: kinds of rooms, cameras."""
