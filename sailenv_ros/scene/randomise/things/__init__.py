"""Things that can be drawn at random, one file each; `thing_table` lists them."""
