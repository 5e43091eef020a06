"""Build of the standard pack: recipe and furniture catalogues in, a pack of glTF files out."""
