"""Commands as people meet them: help, one line for bad input, nothing half-written."""

import json
import sys

import numpy as np
import pytest

from cell.cli import main
from cell.cli.common import parse_parts, parse_seeds, with_json_value
from hal.errors import ConfigError


def run(monkeypatch, *words):
    monkeypatch.setattr(sys, "argv", ["binpick", *map(str, words)])
    monkeypatch.setenv("COLUMNS", "200")
    with pytest.raises(SystemExit) as exit_:
        main()
    return exit_.value.code or 0


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shots") / "shot"
    with pytest.MonkeyPatch.context() as patch:
        words = ("capture", folder, "--count", 3, "--seed", 4, "--shots", 1, "--truth")
        assert run(patch, *words) == 0
    return folder


def one_line(capsys):
    said = capsys.readouterr()
    assert said.err.startswith("binpick: ")
    assert said.err.count("\n") == 1, said.err
    assert "Traceback" not in said.err
    return said.err


@pytest.mark.parametrize("name", ["demo", "see", "capture", "devices", "bench", "conformance"])
def test_every_command_explains_itself(monkeypatch, capsys, name):
    assert run(monkeypatch, name, "--help") == 0
    assert "--json" in capsys.readouterr().out or name == "conformance"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("demo", "--parts", "flywheel"), "flywheel"),
        (("demo", "--count", "-1"), "--count"),
        (("demo", "--count", "61"), "0 to 60"),
        (("demo", "--json", "/"), "is a folder"),
        (("demo", "--json="), "is a folder"),
        (("demo", "--out", "/dev/null"), "cannot be written"),
        (("demo", "--parts", "²"), "²"),
        (("demo", "--shots", "99"), "outside 1..16"),
        (("demo", "--cell", "nowhere.toml"), "nowhere.toml: cannot be read"),
        (("demo", "--control", "gravity"), "unknown control 'gravity'"),
        (("demo", "--control", "mu=sticky"), "needs a number"),
        (("demo", "--parts", "1xshaft:290x50"), "does not fit the bin"),
        (("demo", "--parts", "shaft:200x100"), "overfill the bin; at most 1"),
        (("demo", "--parts", "broken.stl"), "broken.stl"),
        (("demo", "--parts", "2xgear"), "part gear: the fingers fit it nowhere"),
        (("see", "nowhere"), "nowhere: no such folder"),
        (("bench", "everything"), "unknown bench"),
        (("bench", "cell", "--seeds", "many"), "--seeds"),
        (("devices", "toaster"), "not a kind of device"),
    ],
)
def test_bad_input_gets_one_line_and_exit_1(monkeypatch, capsys, tmp_path, words, says):
    monkeypatch.chdir(tmp_path)
    assert run(monkeypatch, *words) == 1
    assert says in one_line(capsys)
    assert not list(tmp_path.rglob("*")) or not any(p.is_file() for p in tmp_path.rglob("*"))


def test_misuse_is_exit_2(monkeypatch):
    assert run(monkeypatch, "demo", "--no-such-option") == 2
    assert run(monkeypatch, "no-such-command") == 2
    assert run(monkeypatch, "see") == 2
    assert run(monkeypatch, "demo", "--seed", "-1") == 2
    assert run(monkeypatch, "capture", "x", "--count", "-5") == 2


def test_a_tray_out_of_reach_is_said_before_anything_moves(monkeypatch, capsys, tmp_path):
    from cell.config import DEMO_CELL

    far = DEMO_CELL.read_text().replace("[0.30, -0.50, 0.05]", "[0.30, -1.60, 0.05]")
    (tmp_path / "cell.toml").write_text(far)
    monkeypatch.chdir(tmp_path)
    assert run(monkeypatch, "demo", "--cell", "cell.toml", "--count", "1") == 1
    assert "tray at (0.300, -1.600, 0.050) m" in one_line(capsys)
    assert not (tmp_path / "out" / "demo" / "report.html").exists()


def test_see_finds_what_capture_took(monkeypatch, capsys, shot, tmp_path):
    answer, picture = tmp_path / "see.json", tmp_path / "seen.png"
    assert run(monkeypatch, "see", shot, "--json", answer, "--picture", picture) == 0
    parts = json.loads(answer.read_text())["parts"]
    assert len(parts) == 3
    for part in parts:
        assert part["error"]["position_mm"] < 1.0
        assert not part["error"]["is_flipped"]
        assert part["unobservable"] == ["rotation z"]
        assert np.shape(part["T_base_part"]) == (4, 4)
    assert picture.read_bytes()[:4] == b"\x89PNG"


def test_json_without_a_file_goes_to_standard_output_alone(monkeypatch, capsys, shot):
    assert run(monkeypatch, "see", shot, "--json") == 0
    assert len(json.loads(capsys.readouterr().out)["parts"]) == 3


def test_a_folder_is_never_overwritten(monkeypatch, capsys, shot):
    before = {p.name: p.read_bytes() for p in shot.iterdir()}
    assert run(monkeypatch, "capture", shot, "--count", 1) == 1
    assert "exists already" in one_line(capsys)
    assert before == {p.name: p.read_bytes() for p in shot.iterdir()}


def test_images_of_another_rig_are_refused(monkeypatch, capsys, shot, tmp_path):
    other = tmp_path / "other"
    assert run(monkeypatch, "capture", other, "--count", 1, "--shots", 1, "--seed", 5) == 0
    capsys.readouterr()
    assert run(monkeypatch, "see", shot, "--calibration", other / "calibration.json") == 1
    assert "calibrat" in one_line(capsys)


def test_swapped_images_are_noticed(monkeypatch, capsys, shot, tmp_path):
    import shutil

    swapped = tmp_path / "swapped"
    shutil.copytree(shot, swapped)
    left, right = swapped / "left_00.png", swapped / "right_00.png"
    a, b = left.read_bytes(), right.read_bytes()
    left.write_bytes(b)
    right.write_bytes(a)
    assert run(monkeypatch, "see", swapped) == 1
    assert "swap" in one_line(capsys)


@pytest.mark.parametrize("control", ["dark", "saturated", "swapped", "mirrored"])
def test_images_that_cannot_be_used_stop_the_demo_in_one_line(
    monkeypatch, capsys, tmp_path, control
):
    monkeypatch.chdir(tmp_path)
    words = ("demo", "--count", 2, "--shots", 1, "--control", control)
    assert run(monkeypatch, *words) == 1
    one_line(capsys)
    assert not any(p.is_file() for p in tmp_path.rglob("*"))


def test_json_may_stand_alone_or_name_a_file():
    assert with_json_value(["demo", "--json"]) == ["demo", "--json", "-"]
    assert with_json_value(["demo", "--json", "--seed", "1"]) == [
        "demo",
        "--json",
        "-",
        "--seed",
        "1",
    ]
    assert with_json_value(["demo", "--json", "a.json"]) == ["demo", "--json", "a.json"]


@pytest.mark.parametrize(
    ("text", "means"),
    [
        ("12", ("shaft", 12)),
        ("20xshaft-slim", ("shaft-slim", 20)),
        ("8xshaft:16x30,24x30", ("shaft:16x30,24x30", 8)),
        ("axle.stl", ("axle.stl", None)),
        ("3x3.stl", ("3.stl", 3)),
    ],
)
def test_parts_are_a_number_a_name_or_both(text, means):
    assert parse_parts(text) == means


def test_seeds_are_numbers_and_ranges():
    assert parse_seeds("0-2,7") == [0, 1, 2, 7]
    for bad in ("", "a", "1-", "3-1", "0-99999"):
        with pytest.raises(ConfigError):
            parse_seeds(bad)


def test_an_interrupted_demo_leaves_nothing_half_written(tmp_path):
    import signal
    import subprocess
    import time

    command = [sys.executable, "-m", "cell", "demo", "--count", "6", "--out", tmp_path / "out"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob("out/.journal*")) and time.monotonic() < deadline:
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        said = process.communicate(timeout=30)[1]
    assert process.returncode == 130
    assert "interrupted; nothing half-written" in said
    assert list((tmp_path / "out").iterdir()) == []


def test_fuzz_names_its_targets_and_refuses_others(monkeypatch, capsys):
    assert run(monkeypatch, "fuzz") == 0
    assert "abb-codec" in capsys.readouterr().out.split()
    assert run(monkeypatch, "fuzz", "modbus") == 1
    assert "abb-codec" in capsys.readouterr().err


def test_fuzz_reports_as_json(monkeypatch, capsys):
    assert run(monkeypatch, "fuzz", "abb-codec", "--count", 500, "--json") == 0
    report = json.loads(capsys.readouterr().out)
    assert report["inputs"] == 500
    assert report["findings"] == []
