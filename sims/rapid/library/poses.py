"""Positions, orientations and poses: shifts, products, frames."""

import math
from typing import Any

from sims.rapid.builtin import TaskContext, builtin
from sims.rapid.errors import RapidError
from sims.rapid.library.quaternions import (
    Orient,
    Pos,
    Pose,
    about,
    added,
    conjugate,
    cross,
    dot,
    from_axes,
    normalised,
    product,
    rotated,
    unit,
)

__all__: list[str] = []

_NEAR_GIMBAL = 1.0 - 1e-12


@builtin("FUNC robtarget Offs(robtarget Point, num XOffset, num YOffset, num ZOffset)")
def offs(
    task: TaskContext, *, point: list[Any], xoffset: float, yoffset: float, zoffset: float
) -> list[Any]:
    """Shift a target in its work object, millimetres."""
    del task
    return [added(point[0], [xoffset, yoffset, zoffset]), *point[1:]]


@builtin(
    "FUNC robtarget RelTool(robtarget Point, num Dx, num Dy, num Dz \\num Rx \\num Ry \\num Rz)"
)
def rel_tool(
    task: TaskContext,
    *,
    point: list[Any],
    dx: float,
    dy: float,
    dz: float,
    rx: float | None = None,
    ry: float | None = None,
    rz: float | None = None,
) -> list[Any]:
    """Shift and turn a target in its own tool frame: about x, then the new y, then the new z."""
    del task
    q = unit(point[1])
    place = added(point[0], rotated(q, [dx, dy, dz]))
    for axis, angle in enumerate((rx, ry, rz)):
        if angle is not None:
            q = product(q, about(axis, angle))
    return [place, normalised(q), *point[2:]]


@builtin("FUNC pose PoseMult(pose Pose1, pose Pose2)")
def pose_mult(task: TaskContext, *, pose1: Pose, pose2: Pose) -> Pose:
    """``Pose2`` in the frame of ``Pose1``, seen from outside."""
    del task
    q = unit(pose1[1])
    return [added(pose1[0], rotated(q, pose2[0])), normalised(product(q, unit(pose2[1])))]


@builtin("FUNC pose PoseInv(pose Pose)")
def pose_inv(task: TaskContext, *, pose: Pose) -> Pose:
    """Return the inverse."""
    del task
    q = conjugate(unit(pose[1]))
    return [[-part for part in rotated(q, pose[0])], q]


@builtin("FUNC pos PoseVect(pose Pose, pos Pos)")
def pose_vect(task: TaskContext, *, pose: Pose, pos: Pos) -> Pos:
    """Return a position of a frame, seen from outside."""
    del task
    return added(pose[0], rotated(unit(pose[1]), pos))


@builtin("FUNC orient NOrient(orient Rotation)")
def n_orient(task: TaskContext, *, rotation: Orient) -> Orient:
    """Normalise a quaternion."""
    del task
    return normalised(rotation)


@builtin("FUNC orient OrientZYX(num ZAngle, num YAngle, num XAngle)")
def orient_zyx(task: TaskContext, *, zangle: float, yangle: float, xangle: float) -> Orient:
    """Return the orientation of Euler angles, degrees: about z, the new y, the new x."""
    del task
    return product(product(about(2, zangle), about(1, yangle)), about(0, xangle))


@builtin("FUNC num EulerZYX(\\switch X | switch Y | switch Z, orient Rotation)")
def euler_zyx(
    task: TaskContext, *, x: bool = False, y: bool = False, z: bool = False, rotation: Orient
) -> float:
    """Return one Euler angle of an orientation, degrees; looking along z, x is 0."""
    del task
    if not (x or y or z):
        raise RapidError("ERR_ARGVALERR", "EulerZYX: say which angle with \\X, \\Y or \\Z")
    w, i, j, k = unit(rotation)
    sine = 2 * (w * j - i * k)
    if y:
        return math.degrees(math.asin(max(-1.0, min(1.0, sine))))
    if abs(sine) > _NEAR_GIMBAL:
        return 0.0 if x else math.degrees(-2 * math.copysign(1.0, sine) * math.atan2(i, w))
    if x:
        return math.degrees(math.atan2(2 * (w * i + j * k), 1 - 2 * (i * i + j * j)))
    return math.degrees(math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k)))


@builtin("FUNC num DotProd(pos Vector1, pos Vector2)")
def dot_prod(task: TaskContext, *, vector1: Pos, vector2: Pos) -> float:
    """Scalar product."""
    del task
    return dot(vector1, vector2)


@builtin("FUNC pos CrossProd(pos Vector1, pos Vector2)")
def cross_prod(task: TaskContext, *, vector1: Pos, vector2: Pos) -> Pos:
    """Vector product."""
    del task
    return cross(vector1, vector2)


@builtin("FUNC num VectMagn(pos Vector)")
def vect_magn(task: TaskContext, *, vector: Pos) -> float:
    """Length of a vector."""
    del task
    return math.hypot(*vector)


@builtin("FUNC num Distance(pos Point1, pos Point2)")
def distance(task: TaskContext, *, point1: Pos, point2: Pos) -> float:
    """Distance of two positions."""
    del task
    return math.dist(point1, point2)


@builtin("FUNC pose DefFrame(robtarget NewP1, robtarget NewP2, robtarget NewP3 \\num Origin)")
def def_frame(
    task: TaskContext,
    *,
    newp1: list[Any],
    newp2: list[Any],
    newp3: list[Any],
    origin: float | None = None,
) -> Pose:
    r"""Return the frame of three points.

    ``\Origin:=1`` (and without it): the first is the origin, the second is on x, the third near y.
    2: the second is the origin, the first on negative x. 3: the first two are on x and the origin
    is where the third looks straight at them. ERR_FRAME: the points are on one line.
    """
    del task
    first, second, third = newp1[0], newp2[0], newp3[0]
    x = _direction(first, second)
    kind = 1.0 if origin is None else origin
    if kind not in (1.0, 2.0, 3.0):
        raise RapidError("ERR_ARGVALERR", f"DefFrame: \\Origin:={kind:g}; 1, 2 or 3 are possible")
    z = cross(x, [c - a for a, c in zip(first, third, strict=True)])
    length = math.hypot(*z)
    if length < 1e-6:
        raise RapidError("ERR_FRAME", "DefFrame: the three points are on one line")
    z = [part / length for part in z]
    place = list(second if kind == 2.0 else first)
    if kind == 3.0:
        along = dot(x, [c - a for a, c in zip(first, third, strict=True)])
        place = added(first, [along * part for part in x])
    return [place, from_axes(x, cross(z, x), z)]


def _direction(start: Pos, end: Pos) -> Pos:
    length = math.dist(start, end)
    if length < 1e-6:
        raise RapidError("ERR_FRAME", "DefFrame: two of the three points are the same")
    return [(b - a) / length for a, b in zip(start, end, strict=True)]
