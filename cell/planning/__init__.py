"""Collision-checked motions for a pick."""
