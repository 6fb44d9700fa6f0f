"""The built-in instructions and functions; importing this registers them all."""
