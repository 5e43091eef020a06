"""Data that the stages exchange: frozen, checked values, and the bounds of each."""
