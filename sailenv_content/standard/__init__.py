"""How the standard pack is made: recipe and furniture catalogues in, a pack of glTF files out."""
