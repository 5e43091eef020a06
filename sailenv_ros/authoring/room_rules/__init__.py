"""Kinds of generated rooms: their names, and the rules that their files say."""
