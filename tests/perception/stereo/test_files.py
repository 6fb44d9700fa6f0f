import json

import cv2
import numpy as np
import pytest

from hal import Region, StereoCapture, StereoShot
from hal.errors import ConfigError
from perception import files
from perception.files import read_calibration, read_shot, write_calibration, write_shot
from sims.camera import RigTruth

TRUE = RigTruth.seeded(2).calibration
RNG = np.random.default_rng(3)


def capture_of(shots=2, bits=8):
    kind = np.uint8 if bits == 8 else np.uint16
    regions = (Region(8, 16, 64, 48), Region(0, 24, 64, 48))
    return StereoCapture(
        tuple(
            StereoShot(
                RNG.integers(0, 2**bits, (48, 64), kind),
                RNG.integers(0, 2**bits, (48, 64), kind),
                *regions,
                block_id=k,
                stamp_ns=123_456_789_012_345_678 + k,
                exposure_s=0.0123,
            )
            for k in range(shots)
        ),
        TRUE.serials,
        bits,
    )


@pytest.fixture
def folder(tmp_path):
    place = tmp_path / "shot"
    write_shot(place, capture_of(), TRUE, truth={"parts": [1, 2]})
    return place


@pytest.mark.parametrize("bits", [8, 10, 12, 16])
def test_what_is_written_is_read_back(tmp_path, bits):
    capture = capture_of(3, bits)
    write_shot(tmp_path / "a" / "shot", capture, TRUE, truth={"x": [1.5]})
    found = read_shot(tmp_path / "a" / "shot")
    assert found.truth == {"x": [1.5]}
    assert found.capture.bits == bits
    for mine, other in zip(capture.shots, found.capture.shots, strict=True):
        np.testing.assert_array_equal(mine.left, other.left)
        np.testing.assert_array_equal(mine.right, other.right)
        assert mine.left.dtype == other.left.dtype
        assert vars(mine) | {"left": 0, "right": 0} == vars(other) | {"left": 0, "right": 0}
    back = found.calibration
    assert (back.left, back.right, back.serials) == (TRUE.left, TRUE.right, TRUE.serials)
    np.testing.assert_allclose(back.T_base_left.matrix, TRUE.T_base_left.matrix, atol=1e-12)
    np.testing.assert_allclose(back.T_left_right.matrix, TRUE.T_left_right.matrix, atol=1e-12)


def test_another_calibration_file_may_be_named(folder, tmp_path):
    other = tmp_path / "other.json"
    write_calibration(other, TRUE)
    (folder / "calibration.json").unlink()
    assert read_shot(folder, calibration=other).calibration.serials == TRUE.serials


def test_a_rig_with_other_serials_is_refused(folder, tmp_path):
    other = tmp_path / "other.json"
    write_calibration(other, RigTruth.seeded(5).calibration)
    with pytest.raises(ConfigError, match=r"other\.json: serials: belongs to cameras"):
        read_shot(folder, calibration=other)


def cut_in_half(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flip_a_bit(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(bytes(content))


def in_colour(path):
    cv2.imwrite(str(path), np.zeros((48, 64, 3), np.uint8))


def too_small(path):
    cv2.imwrite(str(path), np.zeros((47, 64), np.uint8))


def too_deep(path):
    cv2.imwrite(str(path), np.full((48, 64), 300, np.uint16))


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda path: path.unlink(), "images, shot.json names 2 pairs"),
        (cut_in_half, "truncated"),
        (flip_a_bit, "damaged"),
        (lambda path: path.write_bytes(b"GIF89a"), "not a PNG"),
        (lambda path: path.write_bytes(b""), "not a PNG"),
        (in_colour, "mono"),
        (too_small, "its region"),
        (too_deep, "8 bits"),
    ],
)
def test_a_spoilt_image_is_named(folder, spoil, words):
    spoil(folder / "right_01.png")
    with pytest.raises(ConfigError, match=words) as caught:
        read_shot(folder)
    assert "\n" not in str(caught.value)


def test_a_missing_image_that_pairs_up_is_named(folder):
    (folder / "right_01.png").rename(folder / "right_07.png")
    with pytest.raises(ConfigError, match=r"right_01\.png: no such file"):
        read_shot(folder)


@pytest.mark.parametrize("name", ["shot.json", "calibration.json"])
@pytest.mark.parametrize("text", ["", "{", "[]", '"x"', "null", "\x00", "{}"])
def test_rubbish_in_place_of_json_is_named(folder, name, text):
    (folder / name).write_text(text)
    with pytest.raises(ConfigError, match=name.replace(".", r"\.")):
        read_shot(folder)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("shots",), []),
        (("shots", 0, "left"), "../left_00.png"),
        (("shots", 0, "left"), "/etc/passwd.png"),
        (("shots", 0, "left_region", "width_px"), 0),
        (("shots", 0, "left_region", "width_px"), "64"),
        (("shots", 0, "exposure_s"), float("nan")),
        (("shots", 0, "gain"), 2),
        (("bits",), 7),
        (("version",), 2),
        (("colour",), True),
    ],
)
def test_a_wrong_key_of_a_shot_is_named(folder, path, value):
    change(folder / "shot.json", path, value)
    with pytest.raises(ConfigError, match=r"shot\.json") as caught:
        read_shot(folder)
    assert str(path[-1]) in str(caught.value)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("left", "focal_x_px"), -1.0),
        (("left", "focal_x_px"), None),
        (("left", "distortion"), [0.0] * 4),
        (("left", "centre_x_px"), float("inf")),
        (("left", "skew"), 0.1),
        (("T_base_left", "quaternion_wxyz"), [1.0, 1.0, 0.0, 0.0]),
        (("T_base_left", "quaternion_wxyz"), [0.0, 0.0, 0.0, 0.0]),
        (("T_left_right", "translation_m"), [0.0, 0.0, 0.0]),
        (("serials", "left"), ""),
        (("format",), "other"),
    ],
)
def test_a_wrong_key_of_a_calibration_is_named(tmp_path, path, value):
    place = tmp_path / "calibration.json"
    write_calibration(place, TRUE)
    change(place, path, value)
    with pytest.raises(ConfigError) as caught:
        read_calibration(place)
    assert str(place) in str(caught.value)
    assert str(path[-1]) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_folder_that_is_there_is_left_alone(folder):
    before = sorted(p.name for p in folder.iterdir())
    with pytest.raises(ConfigError, match="exists already"):
        write_shot(folder, capture_of(), TRUE)
    assert sorted(p.name for p in folder.iterdir()) == before


def test_a_write_that_fails_half_way_leaves_nothing(tmp_path, monkeypatch):
    calls = []

    def failing(path, image):
        calls.append(path)
        if len(calls) == 3:
            raise OSError(28, "No space left on device")
        path.write_bytes(b"x")

    monkeypatch.setattr(files, "write_png", failing)
    with pytest.raises(ConfigError, match="No space left"):
        write_shot(tmp_path / "shot", capture_of(), TRUE)
    assert list(tmp_path.iterdir()) == []


def test_a_calibration_that_cannot_be_written_leaves_the_old_one(tmp_path, monkeypatch):
    place = tmp_path / "calibration.json"
    write_calibration(place, TRUE)
    before = place.read_bytes()
    monkeypatch.setattr(files.json, "dumps", lambda *_, **__: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_calibration(place, TRUE)
    assert place.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["calibration.json"]


def change(path, keys, value):
    content = json.loads(path.read_text())
    inner = content
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = value
    path.write_text(json.dumps(content))
