"""The calibration file a cell would have: the truth, seen through a calibration's own errors.

The errors are drawn from the covariance that a joint calibration on board views has, so that
they hang together as real ones do: focal length, principal point and relative rotation are
each known poorly and compensate in the volume that was calibrated. Independent errors of the
same sizes would spoil depth by several times as much.
"""

from dataclasses import replace
from functools import lru_cache
from math import radians

import cv2
import numpy as np
from numpy.typing import NDArray

from hal import CameraIntrinsics, StereoCalibration, Transform, rotation_from_rotvec
from sims.camera.rig import RigTruth

__all__ = ["calibration_for"]

VIEWS = 20
CORNER_RMS_PX = 0.05
"""Rendered boards give 0.025 px; a real print 0.05-0.15."""
MOUNTING_M = 0.1e-3
MOUNTING_RAD = radians(0.02)
INTRINSICS = 9


@lru_cache(maxsize=16)
def calibration_for(truth: RigTruth, seed: int) -> StereoCalibration:
    """Return what a calibration of this rig would have written to the file.

    Intrinsics and relation as after 20 views of a 12 x 9 board with 0.05 px corner noise;
    the mounting is off by 0.1 mm and 0.02 deg.
    """
    rng = np.random.default_rng([seed, truth.seed, 0xCA11])
    true = truth.calibration
    errors = _joint_errors(true, rng)
    left_errors, right_errors, relation = np.split(errors, (INTRINSICS, 2 * INTRINSICS))
    T_left_right = _turned(true.T_left_right, relation[:3], relation[3:])
    mounting_rad = _direction(rng) * MOUNTING_RAD * rng.uniform(0.7, 1.3)
    mounting_m = _direction(rng) * MOUNTING_M * rng.uniform(0.7, 1.3)
    return StereoCalibration(
        serials=true.serials,
        left=_with_errors(true.left, left_errors),
        right=_with_errors(true.right, right_errors),
        T_left_right=T_left_right,
        T_base_left=_turned(true.T_base_left, mounting_rad, mounting_m),
    )


def _direction(rng: np.random.Generator) -> NDArray[np.float64]:
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector))


def _turned(
    pose: Transform, rotvec_rad: NDArray[np.float64], by_m: NDArray[np.float64]
) -> Transform:
    rotation = rotation_from_rotvec(rotvec_rad) @ pose.rotation
    return Transform.from_parts(pose.parent, pose.child, rotation, pose.translation_m + by_m)


def _parameters(camera: CameraIntrinsics) -> NDArray[np.float64]:
    return np.array(
        [
            camera.focal_x_px,
            camera.focal_y_px,
            camera.centre_x_px,
            camera.centre_y_px,
            *camera.distortion,
        ]
    )


def _with_errors(camera: CameraIntrinsics, errors: NDArray[np.float64]) -> CameraIntrinsics:
    fx, fy, cx, cy, k1, k2, p1, p2, k3 = (float(p) for p in _parameters(camera) + errors)
    return replace(
        camera,
        focal_x_px=fx,
        focal_y_px=fy,
        centre_x_px=cx,
        centre_y_px=cy,
        distortion=(k1, k2, p1, p2, k3),
    )


def _joint_errors(true: StereoCalibration, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw (24,): 9 intrinsics left, 9 right, rotation vector and shift of ``T_left_right``.

    One draw from the first-order covariance of the joint least squares over all views.
    """
    shared = 2 * INTRINSICS + 6
    information = np.zeros((shared, shared))
    for T_left_board in _board_poses(rng):
        jacobian_shared, jacobian_pose = _view_jacobians(true, T_left_board)
        # Each view's own board pose is eliminated (Schur complement).
        cross = jacobian_shared.T @ jacobian_pose
        own = jacobian_pose.T @ jacobian_pose
        information += jacobian_shared.T @ jacobian_shared - cross @ np.linalg.solve(own, cross.T)
    scale = np.sqrt(np.diag(information))
    values, vectors = np.linalg.eigh(information / np.outer(scale, scale))
    draw = rng.normal(size=shared) / np.sqrt(values)
    return np.asarray(CORNER_RMS_PX * (vectors @ draw) / scale)


def _board_poses(rng: np.random.Generator) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Rotation vectors and positions of a board held before the rig: tilted, rolled, moved."""
    poses = []
    for _ in range(VIEWS):
        tilt_rad, around = radians(rng.uniform(5, 32)), rng.uniform(0, 2 * np.pi)
        tilt = rotation_from_rotvec(tilt_rad * np.array([np.cos(around), np.sin(around), 0]))
        roll = rotation_from_rotvec([0, 0, radians(rng.uniform(-60, 60))])
        z_m = rng.uniform(0.52, 0.80)
        centre_m = (0.05 + rng.uniform(-0.25, 0.25) * z_m, rng.uniform(-0.18, 0.18) * z_m, z_m)
        poses.append((cv2.Rodrigues(tilt @ roll)[0].ravel(), np.array(centre_m)))
    return poses


def _board_points() -> NDArray[np.float64]:
    x, y = np.meshgrid((np.arange(11) - 5) * 0.025, (np.arange(8) - 3.5) * 0.025)
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])


def _view_jacobians(
    true: StereoCalibration, board: tuple[NDArray[np.float64], NDArray[np.float64]]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Derivatives of all pixel coordinates of one stereo view: shared (m, 24) and pose (m, 6)."""
    rotation, position_m = board

    def project(change: NDArray[np.float64]) -> NDArray[np.float64]:
        left, right, relation, pose = np.split(change, (9, 18, 24))
        points = _board_points() @ (
            rotation_from_rotvec(pose[:3]) @ cv2.Rodrigues(rotation)[0]
        ).T + (position_m + pose[3:])
        moved = _turned(true.T_left_right, relation[:3], relation[3:]).inverse()
        return np.concatenate(
            [
                _project(_with_errors(true.left, left), points),
                _project(_with_errors(true.right, right), moved.apply(points)),
            ]
        )

    steps = np.array([0.1, 0.1, 0.1, 0.1, 1e-4, 1e-4, 1e-5, 1e-5, 1e-4] * 2 + [1e-6] * 12)
    columns = []
    for index, step in enumerate(steps):
        change = np.zeros(30)
        change[index] = step
        columns.append((project(change) - project(-change)) / (2 * step))
    jacobian = np.stack(columns, axis=1)
    return jacobian[:, :24], jacobian[:, 24:]


def _project(camera: CameraIntrinsics, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
    distortion = np.array(camera.distortion)
    zero = np.zeros(3)
    pixels, _ = cv2.projectPoints(points_m, zero, zero, camera.matrix, distortion)
    return np.asarray(pixels).ravel()
