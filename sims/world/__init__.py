"""The simulated world: physics, arm, gripper, piles, faults, and the truth about them."""

from sims.world.errors import PileError, SimulationError
from sims.world.faults import Faults
from sims.world.piles import PileReport, fill
from sims.world.referee import Place, PlacingError, Referee
from sims.world.settings import Physics
from sims.world.shapes import PartShape, Primitive, cylinders
from sims.world.world import BodyPoses, Snapshot, World

__all__ = [
    "BodyPoses",
    "Faults",
    "PartShape",
    "Physics",
    "PileError",
    "PileReport",
    "Place",
    "PlacingError",
    "Primitive",
    "Referee",
    "SimulationError",
    "Snapshot",
    "World",
    "cylinders",
    "fill",
]
