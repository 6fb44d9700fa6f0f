"""Benches of what needs a simulated world: figures, with a peer in the same run."""
