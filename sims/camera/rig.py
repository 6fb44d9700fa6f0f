"""The stereo rig over the bin: what the drawing says, and what was really mounted.

The two optical axes look straight down. Image x, and with it the baseline, runs along base -y,
image y along base -x: the picture shows the bin as seen from the robot, its far wall on top,
and the bar of the rig lies across the arm's plane, where the elbow does not come.
"""

import zlib
from dataclasses import dataclass, replace
from math import radians, tan
from typing import Self

import numpy as np
from numpy.typing import NDArray

from hal import CameraIntrinsics, StereoCalibration, Transform, rotation_from_rotvec

__all__ = [
    "HOUSING_SIZE_M",
    "PITCH_M",
    "SENSOR_PX",
    "ProjectorOptics",
    "RigTruth",
    "T_base_housing",
    "nominal_calibration",
    "nominal_projector",
]

SENSOR_PX = (1936, 1216)
PITCH_M = 5.86e-6
FOCAL_M = 0.008
BASELINE_M = 0.100
CENTRE_BASE_M = (0.55, 0.0, 0.78)
"""Middle between the two optical centres."""

HOUSING_SIZE_M = (0.16, 0.26, 0.10)
"""Along base x, y, z: cameras, projector, bar, and the mounting's 20 mm of doubt around them."""

_ROTATION_BASE_LEFT = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


def T_base_housing() -> Transform:
    """Middle of the collision box of the rig; its lower face is 30 mm under the lenses' centres."""
    x, y, z = CENTRE_BASE_M
    middle_m = (x + 0.015, y, z - 0.03 + HOUSING_SIZE_M[2] / 2)
    return Transform.from_translation("base", "housing", middle_m)


@dataclass(frozen=True)
class ProjectorOptics:
    """An inverse camera: pinhole, no distortion, pixels at integer centres."""

    width_px: int
    height_px: int
    focal_px: float
    T_base_projector: Transform


def nominal_calibration() -> StereoCalibration:
    """The rig of the drawing: no distortion, centred, parallel. Not good enough to measure with."""
    width_px, height_px = SENSOR_PX
    focal_px = FOCAL_M / PITCH_M
    camera = CameraIntrinsics(
        width_px, height_px, focal_px, focal_px, (width_px - 1) / 2, (height_px - 1) / 2
    )
    centre_m = np.array(CENTRE_BASE_M)
    left_m = centre_m - _ROTATION_BASE_LEFT[:, 0] * (BASELINE_M / 2)
    return StereoCalibration(
        serials=("nominal-left", "nominal-right"),
        left=camera,
        right=camera,
        T_left_right=Transform.from_translation("left", "right", (BASELINE_M, 0.0, 0.0)),
        T_base_left=Transform.from_parts("base", "left", _ROTATION_BASE_LEFT, left_m),
    )


def nominal_projector() -> tuple[ProjectorOptics, Transform]:
    """The pattern projector and its pose in frame ``left``: 30 mm off the baseline's middle."""
    T_left_projector = Transform.from_translation("left", "projector", (BASELINE_M / 2, -0.03, 0.0))
    T_base_projector = nominal_calibration().T_base_left @ T_left_projector
    focal_px = 640 / tan(radians(60) / 2)
    return ProjectorOptics(1280, 800, focal_px, T_base_projector), T_left_projector


@dataclass(frozen=True)
class RigTruth:
    """The rig as it really hangs there. Known to the renderer and to benches, never to a cell."""

    seed: int
    calibration: StereoCalibration
    projector: ProjectorOptics

    @classmethod
    def seeded(cls, seed: int) -> Self:
        """Return a rig that differs from the drawing as mounted rigs do.

        Mounting 5-20 mm and 0.5-2 deg; per camera some px of focal length and principal point
        and unequal distortion; baseline some 0.1 mm, relative rotation some 0.1 deg.
        """
        rng = np.random.default_rng([seed, 0x5167])
        nominal = nominal_calibration()
        T_left_right = _moved(nominal.T_left_right, rng, 0.3e-3, 0.3e-3, 0.05, 0.15)
        T_base_left = _moved(nominal.T_base_left, rng, 0.005, 0.020, 0.5, 2.0)
        true = StereoCalibration(
            serials=serials_of(seed),
            left=_lens(nominal.left, rng, (-0.10, 0.12, 3e-4, -2e-4, -0.03), (3.1, -2.4)),
            right=_lens(nominal.right, rng, (-0.105, 0.13, -2e-4, 1e-4, -0.04), (-4.2, 1.7)),
            T_left_right=T_left_right,
            T_base_left=T_base_left,
        )
        optics, T_left_projector = nominal_projector()
        T_left_projector = _moved(T_left_projector, rng, 1e-3, 2e-3, 0.1, 0.4)
        projector = replace(optics, T_base_projector=T_base_left @ T_left_projector)
        return cls(seed, true, projector)


def serials_of(seed: int) -> tuple[str, str]:
    """Serial numbers of the left and right camera: ten digits, the same for the same seed."""

    def number(side: str) -> str:
        return f"4{zlib.crc32(f'{side} {seed}'.encode()) % 10**9:09d}"

    return number("left"), number("right")


def _direction(rng: np.random.Generator) -> NDArray[np.float64]:
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector))


def _moved(
    pose: Transform,
    rng: np.random.Generator,
    low_m: float,
    high_m: float,
    low_degrees: float,
    high_degrees: float,
) -> Transform:
    """Move a pose by a distance and an angle from the given ranges, in random directions."""
    shift_m = _direction(rng) * rng.uniform(low_m, high_m)
    turn = rotation_from_rotvec(_direction(rng) * radians(rng.uniform(low_degrees, high_degrees)))
    return Transform.from_parts(
        pose.parent, pose.child, pose.rotation @ turn, pose.translation_m + shift_m
    )


def _lens(
    nominal: CameraIntrinsics,
    rng: np.random.Generator,
    distortion: tuple[float, float, float, float, float],
    centre_shift_px: tuple[float, float],
) -> CameraIntrinsics:
    focal_px = nominal.focal_x_px + rng.choice([-1, 1]) * rng.uniform(2.0, 6.0)
    k1, k2, p1, p2, k3 = distortion
    k1, k2, k3 = (k * rng.uniform(0.9, 1.1) for k in (k1, k2, k3))
    return replace(
        nominal,
        focal_x_px=float(focal_px),
        focal_y_px=float(focal_px + rng.normal(0, 0.3)),
        centre_x_px=float(nominal.centre_x_px + centre_shift_px[0] + rng.normal(0, 1.0)),
        centre_y_px=float(nominal.centre_y_px + centre_shift_px[1] + rng.normal(0, 1.0)),
        distortion=(float(k1), float(k2), p1, p2, float(k3)),
    )
