"""A simulated ABB robot controller: motion, state, signals, event log around RAPID tasks."""
