"""One TOML file describes a cell: read once, checked once, never changed."""

import tomllib
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from hal import Bin, Fingers, Layout, Transform, Tray
from hal.errors import ConfigError

__all__ = [
    "CameraConfig",
    "CellConfig",
    "ChargeConfig",
    "DeviceConfig",
    "GraspConfig",
    "MotionConfig",
    "load_cell",
    "with_shots",
]

MOST_SHOTS = 16
DEMO_CELL = Path(__file__).parent / "demo" / "demo.toml"

Metres = Annotated[float, Field(gt=0, le=5)]
Position = tuple[
    Annotated[float, Field(ge=-5, le=5)],
    Annotated[float, Field(ge=-5, le=5)],
    Annotated[float, Field(ge=-5, le=5)],
]


class Section(BaseModel):
    """Unknown keys are refused; values never change."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class DeviceConfig(Section):
    """Which backend, at which address; the rest of the table goes to the backend."""

    backend: str
    address: str
    options: dict[str, Any] = Field(default_factory=dict)


class CameraConfig(DeviceConfig):
    """The stereo rig and how it looks."""

    shots: int = Field(default=4, ge=1, le=MOST_SHOTS)
    exposure_s: float = Field(default=0.008, ge=2e-5, le=0.1)
    calibration: str = ""
    margin_m: float = Field(default=0.02, ge=0, le=0.2)
    housing_size_m: tuple[Metres, Metres, Metres] = (0.16, 0.26, 0.10)
    housing_position_m: Position = (0.565, 0.0, 0.80)
    timeout_s: float = Field(default=5.0, gt=0, le=60)


class MotionConfig(Section):
    """Speeds: fractions of the joint speeds, metres a second on lines."""

    transit_speed: float = Field(default=1.0, gt=0, le=1)
    loaded_speed: float = Field(default=0.8, gt=0, le=1)
    approach_mps: float = Field(default=0.25, gt=0, le=1.5)
    retreat_mps: float = Field(default=0.25, gt=0, le=1.5)
    place_mps: float = Field(default=0.25, gt=0, le=1.5)
    zone_m: float = Field(default=0.01, ge=0, le=0.2)


class GraspConfig(Section):
    """How parts are gripped and let go."""

    force_n: float = Field(default=90.0, ge=70, le=100)
    closing_mps: float = Field(default=0.05, ge=0.001, le=0.05)
    opening_margin_m: float = Field(default=0.006, gt=0, le=0.02)
    release_margin_m: float = Field(default=0.006, gt=0, le=0.02)
    size_tolerance_m: float = Field(default=0.001, gt=0, le=0.01)
    max_tilt_rad: float = Field(default=0.873, gt=0, le=1.2)
    safety_margin_m: float = Field(default=0.0008, ge=0, le=0.01)
    retries: int = Field(default=2, ge=0, le=10)
    max_consecutive_misses: int = Field(default=6, ge=1, le=100)


class ChargeConfig(Section):
    """What computing costs in the loop's time; 0 is allowed and means free."""

    see_s: float = Field(default=2.0, ge=0, le=60)
    plan_s: float = Field(default=0.5, ge=0, le=60)


class BinConfig(Section):
    """Inner size and the middle of the inner floor."""

    size_m: tuple[Metres, Metres, Metres] = (0.36, 0.26, 0.14)
    wall_m: Metres = 0.005
    position_m: Position = (0.55, 0.0, 0.05)


class TrayConfig(Section):
    """Size and the middle of the top face."""

    size_m: tuple[Metres, Metres] = (0.40, 0.36)
    position_m: Position = (0.30, -0.50, 0.05)


class FingersConfig(Section):
    """The fingertips' box; see ``hal.Fingers``."""

    thickness_m: Metres = 0.004
    width_m: Metres = 0.014
    length_m: Metres = 0.070
    tcp_m: Metres = 0.160


class CellConfig(Section):
    """The whole file."""

    name: str = "demo"
    arm: str = "irb1200-5-0.9"
    robot: DeviceConfig
    gripper: DeviceConfig
    camera: CameraConfig
    projector: DeviceConfig
    bin: BinConfig = BinConfig()
    tray: TrayConfig = TrayConfig()
    fingers: FingersConfig = FingersConfig()
    motion: MotionConfig = MotionConfig()
    grasp: GraspConfig = GraspConfig()
    charge: ChargeConfig = ChargeConfig()

    @model_validator(mode="after")
    def _bin_and_tray_apart(self) -> Self:
        gaps = [
            abs(self.bin.position_m[k] - self.tray.position_m[k])
            - self.bin.size_m[k] / 2
            - self.bin.wall_m
            - self.tray.size_m[k] / 2
            for k in (0, 1)
        ]
        if max(gaps) < 0:
            raise ValueError(f"bin and tray overlap by {-max(gaps):.3f} m; move tray.position_m")
        return self

    @model_validator(mode="after")
    def _stands_on_the_floor(self) -> Self:
        for name, height_m in (("bin", self.bin.position_m[2]), ("tray", self.tray.position_m[2])):
            if not 0 <= height_m <= 1:
                raise ValueError(f"{name}.position_m puts it {height_m:g} m over the floor")
        palm_end_m = Fingers().palm_end_m
        if self.fingers.tcp_m + 0.010 - self.fingers.length_m < palm_end_m - 0.02:
            raise ValueError("fingers.length_m reaches into the palm; shorten it or enlarge tcp_m")
        if self.fingers.tcp_m <= palm_end_m or self.fingers.width_m > 0.05:
            raise ValueError("fingers.tcp_m must clear the palm, and width_m be at most 0.05")
        return self

    @property
    def layout(self) -> Layout:
        """Bin, tray and fingers as values."""
        return Layout(
            bin=Bin(
                self.bin.size_m,
                self.bin.wall_m,
                Transform.from_translation("base", "bin", self.bin.position_m),
            ),
            tray=Tray(
                self.tray.size_m,
                Transform.from_translation("base", "tray", self.tray.position_m),
            ),
            fingers=Fingers(**self.fingers.model_dump()),
        )


def load_cell(path: Path | None = None) -> CellConfig:
    """Read a cell file; without a path, the demo's.

    Raises
    ------
    ConfigError
        Missing, not TOML, an unknown key or a value out of range; names file and key.
    """
    path = path or DEMO_CELL
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"cannot be read: {error.strerror}", source=str(path)) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"is not TOML: {error}", source=str(path)) from error
    try:
        return CellConfig.model_validate(table)
    except ValidationError as error:
        raise _first_problem(error, path) from error


def with_shots(config: CellConfig, shots: int) -> CellConfig:
    """Return the same cell with another number of shots a capture.

    Raises
    ------
    ConfigError
        Outside 1..16.
    """
    if not 1 <= shots <= MOST_SHOTS:
        raise ConfigError(f"{shots} is outside 1..{MOST_SHOTS}", key="--shots")
    camera = config.camera.model_copy(update={"shots": shots})
    return config.model_copy(update={"camera": camera})


def _first_problem(error: ValidationError, path: Path) -> ConfigError:
    problem = error.errors(include_url=False)[0]
    key = ".".join(str(part) for part in problem["loc"])
    if problem["type"] == "extra_forbidden":
        message = "is not a key of a cell file; remove it or check its spelling"
    elif problem["type"] == "missing":
        message = "is missing"
    else:
        said = repr(problem["input"])
        message = problem["msg"].removeprefix("Value error, ")
        message = f"{message}, got {said}" if len(said) < 60 else message
    more = error.error_count() - 1
    if more:
        message += f" (and {more} more)"
    return ConfigError(message, source=str(path), key=key)
