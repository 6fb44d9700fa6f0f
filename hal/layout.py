"""What stands in a cell besides devices: bin, tray, fingers. Plain sizes and places."""

from dataclasses import dataclass, field

from hal.transform import Transform

__all__ = ["Bin", "Fingers", "Layout", "Tray"]


@dataclass(frozen=True)
class Bin:
    """An open box. Frame ``bin``: origin at the middle of the inner floor, z up."""

    size_m: tuple[float, float, float] = (0.36, 0.26, 0.14)
    wall_m: float = 0.005
    T_base_bin: Transform = field(
        default_factory=lambda: Transform.from_translation("base", "bin", (0.55, 0.0, 0.05))
    )


@dataclass(frozen=True)
class Tray:
    """A flat foam-lined plate. Frame ``tray``: origin at the middle of its top face, z up."""

    size_m: tuple[float, float] = (0.40, 0.36)
    T_base_tray: Transform = field(
        default_factory=lambda: Transform.from_translation("base", "tray", (0.30, -0.50, 0.05))
    )


@dataclass(frozen=True)
class Fingers:
    """The fingertips: boxes along the tool axis, and where their middle sits.

    ``thickness_m`` is along the closing direction (tool y), ``width_m`` along tool x,
    ``length_m`` along the tool axis (z). The tool centre point lies ``tcp_m`` from the flange,
    10 mm inside the tips. The palm behind them is a box ``palm_size_m`` along tool x, y and z,
    its middle ``palm_centre_m`` from the flange.
    """

    thickness_m: float = 0.004
    width_m: float = 0.014
    length_m: float = 0.070
    tcp_m: float = 0.160
    palm_size_m: tuple[float, float, float] = (0.050, 0.084, 0.090)
    palm_centre_m: float = 0.050

    @property
    def palm_end_m(self) -> float:
        """How far the palm reaches from the flange."""
        return self.palm_centre_m + self.palm_size_m[2] / 2


@dataclass(frozen=True)
class Layout:
    """All of it."""

    bin: Bin = field(default_factory=Bin)
    tray: Tray = field(default_factory=Tray)
    fingers: Fingers = field(default_factory=Fingers)
