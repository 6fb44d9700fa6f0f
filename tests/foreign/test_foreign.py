import dataclasses
import importlib.util
import sys
from pathlib import Path

import pytest

_spec = importlib.util.spec_from_file_location(
    "foreign_runner", Path(__file__).with_name("runner.py")
)
runner = importlib.util.module_from_spec(_spec)
sys.modules["foreign_runner"] = runner
_spec.loader.exec_module(runner)


def _parameters():
    for scene in runner.scenes():
        fails = scene.table.get("fails")
        marks = [pytest.mark.xfail(strict=True, reason=fails)] if fails else []
        yield pytest.param(scene, id=scene.name, marks=marks)


def _named(name):
    return next(scene for scene in runner.scenes() if scene.name == name)


@pytest.mark.parametrize("scene", list(_parameters()))
def test_a_foreign_program_does_what_the_language_says(scene, tmp_path):
    assert not (wrong := runner.complaints(scene, runner.run(scene, tmp_path))), "\n".join(wrong)


@pytest.mark.parametrize(
    "change",
    [
        {"lines": ["another"]},
        {"lines_among": ["another"]},
        {"data": {"T_ROB1.level": 12}},
        {"near": {"T_ROB1.level": {"value": 12, "within": 0.5}}},
        {"outputs": {"do6": 1}},
        {"files": {"log.txt": ""}},
        {"joints_deg": [21, -10, -20, 30, 40, 51]},
        {"tool0_mm": [335.053, 156.844, 1095]},
        {"numbers": [4711]},
        {"duration_s": [30.0, 60.0]},
        {"ends": "exit"},
    ],
    ids=lambda change: next(iter(change)),
)
def test_a_wrong_expectation_is_noticed(change, tmp_path):
    scene = _named("22_stops_with_error")
    changed = dataclasses.replace(scene, table={**scene.table, **change})
    assert runner.complaints(changed, runner.run(changed, tmp_path))


def test_a_client_notices_a_wrong_byte(tmp_path):
    scene = _named("03_string_server")
    clients = [{"port": 4000, "exchange": [["send", "FLY\n"], ["expect", "OK\n"]]}]
    changed = dataclasses.replace(scene, table={**scene.table, "clients": clients})
    with pytest.raises(AssertionError, match="heard"):
        runner.run(changed, tmp_path)
