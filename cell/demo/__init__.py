"""The demo: a simulated bin emptied from images, scored by the world that knows the truth."""
