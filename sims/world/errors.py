"""What can go wrong in the simulated world itself."""

from hal.errors import CellError

__all__ = ["PileError", "SimulationError"]


class SimulationError(CellError):
    """The physics went where no figure is worth anything: not finite, or fallen through."""


class PileError(SimulationError):
    """The parts would not come to rest in the bin."""
