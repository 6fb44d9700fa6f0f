"""RAPID trees to operations that the machine runs."""

from sims.rapid.compile.emitter import Code
from sims.rapid.compile.routine import compile_routine, evaluate

__all__ = ["Code", "compile_routine", "evaluate"]
