"""The one physics setting of the cell, for the pile and for the grasp.

Why these numbers: ``docs/decisions/0002-one-physics-setting.md``.
"""

from dataclasses import dataclass

__all__ = ["Contact", "FingerServo", "Physics"]


@dataclass(frozen=True)
class Contact:
    """How stiff a contact is, in MuJoCo's terms: ``solref`` and ``solimp``."""

    time_constant_s: float = 0.004
    impedance_min: float = 0.95
    impedance_max: float = 0.99
    impedance_width_m: float = 0.001

    @property
    def solref(self) -> str:
        """As MJCF has it, critically damped."""
        return f"{self.time_constant_s:g} 1"

    @property
    def solimp(self) -> str:
        """As MJCF has it."""
        return f"{self.impedance_min:g} {self.impedance_max:g} {self.impedance_width_m:g}"


@dataclass(frozen=True)
class FingerServo:
    """The stepper axis that drives both fingers, seen at the opening width.

    ``gain`` (N/m) and ``damping`` (N s/m) act on the width, so that the actuator's force is
    the force per finger; ``armature_kg`` is the rotor's inertia at each finger.
    """

    gain: float = 1.0e5
    damping: float = 60.0
    armature_kg: float = 0.4
    joint_damping: float = 20.0


@dataclass(frozen=True)
class Physics:
    """Solver, contacts and friction; ``tick_ns`` is the time step.

    ``pad_stiffness`` (N/m) is one finger's, pad and bending together, against a part that
    touches it along a line.
    """

    tick_ns: int = 2_000_000
    impratio: float = 10.0
    noslip_iterations: int = 0
    iterations: int = 100
    line_search_iterations: int = 50
    tolerance: float = 1e-8
    sleep_tolerance: float = 5e-3
    newton_up_to: int = 60
    part_friction: float = 0.25
    pad_friction: float = 0.6
    pad_torsion_m: float = 0.005
    turn_damping_per_s: float = 10.0
    foam_friction: float = 1.0
    foam_rolling_m: float = 0.004
    part_contact: Contact = Contact()
    pad_stiffness: float = 5.0e5
    stop_contact: Contact = Contact(0.004, 0.99, 0.999, 0.0005)
    lock_contact: Contact = Contact(0.004, 0.999, 0.999, 0.001)
    fingers: FingerServo = FingerServo()

    def free_damping(self, inertia: tuple[float, float, float]) -> float:
        """Return a part's drag, a cheap rolling resistance: it slows the fastest spin axis."""
        return self.turn_damping_per_s * min(inertia)

    def pad_impedance(self, inverse_mass: float) -> float:
        """Return the contact impedance that gives the pads their stiffness.

        The engine scales a contact's softness by the masses that meet (``inverse_mass``, 1/kg):
        one impedance for all would let the pads sink 2 mm into a part of 7 g and be lost at
        every bend of the way by one of 600 g. A line touches at two points.
        """
        per_point = self.pad_stiffness / 2
        softness = 1 / (self.part_contact.time_constant_s**2 * per_point * inverse_mass)
        return min(max(1 - softness, 0.5), 0.9999)

    @property
    def tick_s(self) -> float:
        """Time step in seconds."""
        return self.tick_ns / 1e9
