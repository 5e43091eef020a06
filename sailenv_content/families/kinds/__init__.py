"""The families, one module each; `registry` says which family is where."""
