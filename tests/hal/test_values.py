import numpy as np
import pytest

from hal import (
    Address,
    Backend,
    Figure,
    GripperLimits,
    JointTarget,
    Kind,
    LinearTarget,
    Load,
    Region,
    Registry,
    RobotLimits,
    Scheme,
    Transform,
)
from hal.errors import CellError, ConfigError, DeviceError, DeviceTimeoutError, SafetyError

LIMITS = RobotLimits((-1.0, -2.0), (1.0, 2.0), (1.0, 1.0), 1.0, 5.0)


def test_joints_outside_the_range_are_refused_with_the_joint_and_the_range():
    LIMITS.check_joints((1.0, -2.0))
    with pytest.raises(ValueError, match=r"joint 2: 2.1000 rad is outside -2.0000..2.0000"):
        LIMITS.check_joints((0.0, 2.1))
    with pytest.raises(ValueError, match="3 joints given, the arm has 2"):
        LIMITS.check_joints((0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="joint 1"):
        LIMITS.check_joints((float("nan"), 0.0))


@pytest.mark.parametrize(
    "make",
    [
        lambda: JointTarget((0.0, float("inf"))),
        lambda: JointTarget((0.0,), speed=0.0),
        lambda: JointTarget((0.0,), speed=1.1),
        lambda: JointTarget((0.0,), zone_m=-0.1),
        lambda: LinearTarget(Transform.identity("base", "tcp"), speed_mps=0.0),
        lambda: LinearTarget(Transform.identity("base", "tcp"), zone_m=float("nan")),
        lambda: Load(-1.0),
        lambda: Load(1.0, (0.0, float("nan"), 0.0)),
        lambda: Region(-1, 0, 4, 4),
        lambda: Region(0, 0, 0, 4),
    ],
)
def test_values_that_cannot_be_are_refused(make):
    with pytest.raises(ValueError, match=r"\S"):
        make()


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"width_m": 0.0351}, "width 0.0351 m"),
        ({"force_n": 69.9}, "force 69.9 N is outside 70..100 N"),
        ({"speed_mps": 0.06}, "speed"),
        ({"speed_mps": float("nan")}, "speed"),
    ],
)
def test_a_gripper_is_not_asked_for_what_it_cannot_do(asked, says):
    with pytest.raises(ValueError, match=says):
        GripperLimits().check(**asked)


def test_a_region_cuts_its_pixels_out():
    image = np.arange(12).reshape(3, 4)
    assert image[Region(1, 2, 3, 1).slices].tolist() == [[9, 10, 11]]
    assert not Region(2, 0, 3, 1).is_inside(4, 3)


def test_safety_is_not_a_device_error():
    assert not issubclass(SafetyError, DeviceError)
    assert issubclass(SafetyError, CellError)
    error = DeviceTimeoutError(device="arm", action="move", timeout_s=1.5)
    assert isinstance(error, TimeoutError)
    assert str(error) == "arm: no reply to move in 1.5 s"


BACKENDS = {"json-robot": Backend(Kind.ROBOT, "json:loads", "tcp", needs="nothing")}
SCHEMES = {"tcp": Scheme("socket:create_connection", "tcp:127.0.0.1:5000")}


def test_a_backend_is_found_by_name_and_kind():
    registry = Registry(BACKENDS, schemes=[SCHEMES])
    assert registry.backend("json-robot", Kind.ROBOT).load("json-robot")("[1]") == [1]
    with pytest.raises(ConfigError, match="unknown; known robots: json-robot"):
        registry.backend("jsn-robot", Kind.ROBOT)
    with pytest.raises(ConfigError, match="is a robot; known cameras: none"):
        registry.backend("json-robot", Kind.CAMERA)
    with pytest.raises(ConfigError, match="registered twice"):
        Registry(BACKENDS, BACKENDS)


def test_a_missing_sdk_is_one_devices_trouble():
    backend = Backend(Kind.CAMERA, "no_such_sdk:Camera", "usb", needs="the maker's SDK")
    with pytest.raises(ConfigError, match="eye: needs the maker's SDK"):
        backend.load("eye")


def test_addresses_name_a_known_scheme():
    assert Address.parse("tcp:1.2.3.4:5", known=SCHEMES) == Address("tcp", "1.2.3.4:5")
    with pytest.raises(ConfigError, match="must begin with one of tcp"):
        Address.parse("1.2.3.4:5", known=SCHEMES)


def test_a_figure_is_a_median_with_its_range_and_ratio():
    figure = Figure.median("a.b", [3.0, 1.0, 2.0, 10.0], "s", peer="memcpy", peer_value=5.0)
    assert (figure.value, figure.min, figure.max, figure.n) == (2.5, 1.0, 10.0, 4)
    assert figure.as_json()["ratio"] == 0.5
