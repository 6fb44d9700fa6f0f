"""Rigid transforms that know their two frames.

``T_base_camera`` takes camera coordinates to base coordinates: neighbouring frames cancel,
and a product whose neighbours differ is refused.
"""

from dataclasses import dataclass
from math import inf, isfinite, sqrt
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hal.errors import FrameMismatchError

__all__ = ["Transform", "rotation_from_rotvec", "rotvec_from_rotation"]

ORTHONORMAL_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Transform:
    """Pose of ``child`` in ``parent``.

    Parameters
    ----------
    parent, child
        Frame names, such as ``base`` and ``camera``.
    matrix
        Shape (4, 4), float64, metres; the rotation must be orthonormal to 1e-6.

    Raises
    ------
    ValueError
        The matrix is not a rigid transform.

    Examples
    --------
    >>> T_base_camera = Transform.from_translation("base", "camera", (0, 0, 1))
    >>> T_camera_object = Transform.from_translation("camera", "object", (0, 0.5, 0))
    >>> (T_base_camera @ T_camera_object).translation_m.tolist()
    [0.0, 0.5, 1.0]
    """

    parent: str
    child: str
    matrix: NDArray[np.float64]

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, dtype=np.float64)
        if matrix.shape != (4, 4) or not all(map(isfinite, matrix.ravel().tolist())):
            raise ValueError(f"T_{self.parent}_{self.child}: need a finite (4, 4) matrix")
        rows = matrix.tolist()
        residual = _residual(rows)
        if residual > ORTHONORMAL_TOLERANCE:
            raise ValueError(f"T_{self.parent}_{self.child}: not a rotation (off by {residual:g})")
        if rows[3] != [0.0, 0.0, 0.0, 1.0]:
            raise ValueError(f"T_{self.parent}_{self.child}: last row is {matrix[3]}")
        matrix.setflags(write=False)
        object.__setattr__(self, "matrix", matrix)

    @classmethod
    def identity(cls, parent: str, child: str) -> Self:
        """Two frames that coincide."""
        return cls(parent, child, np.eye(4))

    @classmethod
    def from_translation(cls, parent: str, child: str, translation_m: ArrayLike) -> Self:
        """No rotation; ``translation_m`` has shape (3,)."""
        return cls.from_parts(parent, child, np.eye(3), translation_m)

    @classmethod
    def from_parts(
        cls, parent: str, child: str, rotation: ArrayLike, translation_m: ArrayLike
    ) -> Self:
        """From a (3, 3) rotation and a (3,) translation in metres."""
        matrix = np.eye(4)
        matrix[:3, :3] = rotation
        matrix[:3, 3] = translation_m
        return cls(parent, child, matrix)

    @classmethod
    def from_quaternion(
        cls, parent: str, child: str, quaternion_wxyz: ArrayLike, translation_m: ArrayLike
    ) -> Self:
        """From a unit quaternion (w, x, y, z), normalised here, and a translation in metres."""
        w, x, y, z = np.asarray(quaternion_wxyz, float).tolist()
        size = sqrt(w * w + x * x + y * y + z * z)
        place = np.asarray(translation_m, float).tolist()
        if not (0 < size < inf and all(map(isfinite, place))):
            raise ValueError(f"T_{parent}_{child}: not finite, or no rotation")
        w, x, y, z = w / size, x / size, y / size, z / size
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), place[0]],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), place[1]],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), place[2]],
            [0.0, 0.0, 0.0, 1.0],
        ]
        return cls._rigid(parent, child, np.array(rows))

    @classmethod
    def _rigid(cls, parent: str, child: str, matrix: NDArray[np.float64]) -> Self:
        """Of a matrix that was made rigid, and that nobody else holds: not looked at again."""
        self = object.__new__(cls)
        matrix.setflags(write=False)
        for name, value in (("parent", parent), ("child", child), ("matrix", matrix)):
            object.__setattr__(self, name, value)
        return self

    @property
    def rotation(self) -> NDArray[np.float64]:
        """Shape (3, 3)."""
        return self.matrix[:3, :3]

    @property
    def translation_m(self) -> NDArray[np.float64]:
        """Shape (3,), metres."""
        return self.matrix[:3, 3]

    @property
    def quaternion_wxyz(self) -> NDArray[np.float64]:
        """Shape (4,), (w, x, y, z), w >= 0."""
        r = self.rotation
        # Bar-Itzhack: the largest eigenvector of this matrix is the quaternion, for any angle.
        k = np.array(
            [
                [r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0],
                [r[1, 0] + r[0, 1], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
                [r[2, 0] + r[0, 2], r[2, 1] + r[1, 2], r[2, 2] - r[0, 0] - r[1, 1], 0],
                [
                    r[2, 1] - r[1, 2],
                    r[0, 2] - r[2, 0],
                    r[1, 0] - r[0, 1],
                    r[0, 0] + r[1, 1] + r[2, 2],
                ],
            ]
        )
        x, y, z, w = np.linalg.eigh(k / 3)[1][:, -1]
        quaternion = np.array([w, x, y, z])
        return -quaternion if w < 0 else quaternion

    def inverse(self) -> "Transform":
        """The same relation seen from the other side."""
        rotation = self.rotation.T
        return Transform.from_parts(
            self.child, self.parent, rotation, -rotation @ self.translation_m
        )

    def apply(self, points_m: NDArray[np.floating]) -> NDArray[np.float64]:
        """Take points of shape (..., 3) from ``child`` to ``parent`` coordinates."""
        return np.asarray(points_m @ self.rotation.T + self.translation_m)

    def renamed(self, parent: str, child: str) -> "Transform":
        """The same numbers under other frame names."""
        return Transform(parent, child, self.matrix)

    def __matmul__(self, other: "Transform") -> "Transform":
        if self.child != other.parent:
            raise FrameMismatchError(
                f"T_{self.parent}_{self.child} @ T_{other.parent}_{other.child}"
            )
        matrix = self.matrix @ other.matrix
        matrix[3] = (0, 0, 0, 1)
        return Transform(self.parent, other.child, matrix)

    def __repr__(self) -> str:
        x, y, z = self.translation_m
        rx, ry, rz = rotvec_from_rotation(self.rotation)
        return (
            f"T_{self.parent}_{self.child}(xyz_m=({x:.6f}, {y:.6f}, {z:.6f}), "
            f"rotvec_rad=({rx:.6f}, {ry:.6f}, {rz:.6f}))"
        )


def _residual(rows: list[list[float]]) -> float:
    """How far the upper left of a matrix is from a rotation; infinite for a mirror.

    In plain floats: on nine numbers numpy's overhead is ten times the work.
    """
    (a, b, c, _), (d, e, f, _), (g, h, i, _) = rows[:3]
    residual = max(
        abs(a * a + b * b + c * c - 1),
        abs(d * d + e * e + f * f - 1),
        abs(g * g + h * h + i * i - 1),
        abs(a * d + b * e + c * f),
        abs(a * g + b * h + c * i),
        abs(d * g + e * h + f * i),
    )
    is_mirrored = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0
    return inf if is_mirrored else residual


def rotation_from_rotvec(rotvec_rad: ArrayLike) -> NDArray[np.float64]:
    """Rodrigues: (3,) rotation vector in radians to a (3, 3) rotation."""
    x, y, z = np.asarray(rotvec_rad, float)
    angle_rad = float(np.sqrt(x * x + y * y + z * z))
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    if angle_rad < 1e-12:
        return np.asarray(np.eye(3) + skew)
    a = np.sin(angle_rad) / angle_rad
    b = (1 - np.cos(angle_rad)) / angle_rad**2
    return np.asarray(np.eye(3) + a * skew + b * skew @ skew)


def rotvec_from_rotation(rotation: NDArray[np.floating]) -> NDArray[np.float64]:
    """(3, 3) rotation to a (3,) rotation vector in radians, angle in [0, pi]."""
    r = rotation
    axis = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    sine = float(np.linalg.norm(axis)) / 2
    angle_rad = float(np.arctan2(sine, (np.trace(r) - 1) / 2))
    if sine > 1e-9:
        return np.asarray(axis * (angle_rad / (2 * sine)))
    if angle_rad < 1:
        return np.asarray(axis / 2)
    # Half a turn: the axis is the eigenvector of r + 1.
    column = (r + np.eye(3))[:, int(np.argmax(np.diag(r)))]
    return np.asarray(column / np.linalg.norm(column) * angle_rad)
