"""Quaternions (w, x, y, z) and poses as RAPID has them: millimetres, degrees, plain lists."""

import math
from collections.abc import Sequence

from sims.rapid.errors import RapidError

__all__ = [
    "Orient",
    "Pos",
    "Pose",
    "about",
    "added",
    "conjugate",
    "cross",
    "dot",
    "from_axes",
    "normalised",
    "product",
    "rotated",
    "unit",
]

Pos = list[float]
Orient = list[float]
Pose = list[list[float]]

_MOST_NORM_ERROR = 0.1


def normalised(q: Sequence[float]) -> Orient:
    """Return the quaternion of length 1. ERR_ORIENT_VALUE: it has none."""
    length = math.hypot(*q)
    if not (length > 1e-12 and math.isfinite(length)):
        raise RapidError("ERR_ORIENT_VALUE", f"orientation {list(q)} has the norm {length:g}")
    return [part / length for part in q]


def unit(q: Sequence[float]) -> Orient:
    """Normalise a quaternion that is one but for rounding. ERR_ORIENT_VALUE: it is not."""
    length = math.hypot(*q)
    if not abs(length - 1.0) <= _MOST_NORM_ERROR:
        raise RapidError(
            "ERR_ORIENT_VALUE",
            f"orientation {list(q)} has the norm {length:.4f}: normalise it with NOrient",
            number=40512,
        )
    return [part / length for part in q]


def product(a: Sequence[float], b: Sequence[float]) -> Orient:
    """``a`` after ``b`` seen from outside; ``b`` in the frame of ``a``."""
    w, x, y, z = a
    v, i, j, k = b
    return [
        w * v - x * i - y * j - z * k,
        w * i + x * v + y * k - z * j,
        w * j - x * k + y * v + z * i,
        w * k + x * j - y * i + z * v,
    ]


def conjugate(q: Sequence[float]) -> Orient:
    """Return the inverse rotation."""
    return [q[0], -q[1], -q[2], -q[3]]


def rotated(q: Sequence[float], v: Sequence[float]) -> Pos:
    """Turn a vector."""
    return product(product(q, [0.0, *v]), conjugate(q))[1:]


def about(axis: int, angle_deg: float) -> Orient:
    """Turn about x (0), y (1) or z (2)."""
    half = math.radians(angle_deg) / 2.0
    q = [math.cos(half), 0.0, 0.0, 0.0]
    q[axis + 1] = math.sin(half)
    return q


def added(a: Sequence[float], b: Sequence[float]) -> Pos:
    """Sum of two vectors."""
    return [p + q for p, q in zip(a, b, strict=True)]


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    """Scalar product."""
    return sum(p * q for p, q in zip(a, b, strict=True))


def cross(a: Sequence[float], b: Sequence[float]) -> Pos:
    """Vector product."""
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def from_axes(x: Sequence[float], y: Sequence[float], z: Sequence[float]) -> Orient:
    """Return the orientation whose axes these unit vectors are; its first part is not negative."""
    trace = x[0] + y[1] + z[2]
    squares = [1 + trace, 1 + 2 * x[0] - trace, 1 + 2 * y[1] - trace, 1 + 2 * z[2] - trace]
    largest = max(range(4), key=lambda k: squares[k])
    # Through the largest part: dividing by a small one would lose digits.
    s = 2 * math.sqrt(squares[largest])
    off = (y[2] - z[1], z[0] - x[2], x[1] - y[0])
    sums = {(0, 1): y[0] + x[1], (0, 2): z[0] + x[2], (1, 2): z[1] + y[2]}
    q = [0.0] * 4
    q[largest] = s / 4
    if largest == 0:
        q[1:] = [part / s for part in off]
    else:
        q[0] = off[largest - 1] / s
        for other in range(3):
            if other != largest - 1:
                pair = (min(other, largest - 1), max(other, largest - 1))
                q[other + 1] = sums[pair] / s
    return [-part for part in q] if q[0] < 0 else q
