"""Content of the standard pack: procedural models, and the recipe that builds the pack."""
