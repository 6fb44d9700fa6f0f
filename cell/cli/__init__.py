"""The command line: ``binpick``."""

from cell.cli.app import main

__all__ = ["main"]
