"""The cycle, its configuration, its journal and report, the command line."""
