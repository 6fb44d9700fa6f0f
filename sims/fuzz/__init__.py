"""Fuzzers: hostile bytes for every reader of bytes, steered by the lines they reach."""

from sims.fuzz.engine import FuzzReport, Target, fuzz
from sims.fuzz.targets import TARGETS

__all__ = ["TARGETS", "FuzzReport", "Target", "fuzz"]
