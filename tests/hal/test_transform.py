import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal import Transform, rotation_from_rotvec, rotvec_from_rotation
from hal.errors import FrameMismatchError

angles = st.floats(-3, 3, allow_subnormal=False)
vectors = st.tuples(angles, angles, angles)


def pose(parent: str, child: str, rotvec: tuple, translation: tuple) -> Transform:
    return Transform.from_parts(parent, child, rotation_from_rotvec(rotvec), translation)


@given(vectors, vectors)
def test_a_transform_times_its_inverse_is_nothing(rotvec, translation):
    T = pose("base", "camera", rotvec, translation)
    np.testing.assert_allclose((T @ T.inverse()).matrix, np.eye(4), atol=1e-12)


@given(vectors, vectors, vectors, vectors)
def test_applying_a_product_is_applying_one_after_the_other(r1, t1, r2, t2):
    a, b = pose("base", "camera", r1, t1), pose("camera", "object", r2, t2)
    points = np.array([[0.1, -0.2, 0.3], [1.0, 2.0, 3.0]])
    np.testing.assert_allclose((a @ b).apply(points), a.apply(b.apply(points)), atol=1e-12)


@given(vectors)
def test_the_quaternion_means_the_same_rotation(rotvec):
    T = pose("a", "b", rotvec, (0, 0, 0))
    back = Transform.from_quaternion("a", "b", T.quaternion_wxyz, (0, 0, 0))
    np.testing.assert_allclose(back.matrix, T.matrix, atol=1e-9)
    assert T.quaternion_wxyz[0] >= 0


@given(vectors)
def test_the_rotation_vector_means_the_same_rotation(rotvec):
    rotation = rotation_from_rotvec(rotvec)
    back = rotation_from_rotvec(rotvec_from_rotation(rotation))
    np.testing.assert_allclose(back, rotation, atol=1e-7)


@pytest.mark.parametrize("axis", np.eye(3).tolist() + [[0.6, 0.8, 0.0], [-0.6, 0.0, 0.8]])
def test_half_a_turn_has_a_rotation_vector(axis):
    rotation = rotation_from_rotvec(np.pi * np.array(axis))
    rotvec = rotvec_from_rotation(rotation)
    assert np.linalg.norm(rotvec) == pytest.approx(np.pi)
    np.testing.assert_allclose(rotation_from_rotvec(rotvec), rotation, atol=1e-9)


def test_frames_that_do_not_meet_are_refused_by_name():
    with pytest.raises(FrameMismatchError, match="T_base_camera @ T_object_tcp"):
        Transform.identity("base", "camera") @ Transform.identity("object", "tcp")


@pytest.mark.parametrize(
    ("matrix", "says"),
    [
        (np.eye(3), "finite"),
        (np.full((4, 4), np.nan), "finite"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "not a rotation"),
        (np.diag([1.01, 1.0, 1.0, 1.0]), "not a rotation"),
        (
            np.eye(4) + np.eye(4)[[3, 0, 1, 2]] * 0 + np.array([[0] * 4] * 3 + [[1, 0, 0, 0]]),
            "last row",
        ),
    ],
)
def test_what_is_not_rigid_is_refused(matrix, says):
    with pytest.raises(ValueError, match=says):
        Transform("a", "b", matrix)


def test_a_transform_cannot_be_changed():
    T = Transform.identity("a", "b")
    with pytest.raises(ValueError, match="read-only"):
        T.matrix[0, 3] = 1.0
