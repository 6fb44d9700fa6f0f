"""A fuzzer that finds nothing proves nothing: it must find bugs that were planted."""

import importlib.util
import sys
import tomllib
from pathlib import Path

import pytest

import drivers.abb.codec
import drivers.abb.layouts
from sims.fuzz import fuzz
from sims.fuzz.abb_codec import AbbCodec

CODEC, LAYOUTS = drivers.abb.codec, drivers.abb.layouts
MODULES = {"codec": CODEC, "layouts": LAYOUTS}
TABLE = Path(__file__).with_name("planted_bugs.toml").read_text(encoding="utf-8")
BUGS = {bug.pop("name"): bug for bug in tomllib.loads(TABLE)["bug"]}


@pytest.fixture
def planted(monkeypatch, tmp_path):
    """Return a codec with a bug in it."""

    def plant(module, old, new):
        where = MODULES[module]
        text = Path(where.__file__).read_text(encoding="utf-8")
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times"
        path = tmp_path / "buggy.py"
        path.write_text(text.replace(old, new), encoding="utf-8")
        if where is CODEC:
            return load(path, "drivers.abb.buggy_codec")
        buggy = load(path, "drivers.abb.buggy_layouts")
        monkeypatch.setitem(sys.modules, "drivers.abb.layouts", buggy)
        return load(Path(CODEC.__file__), "drivers.abb.buggy_codec")

    def load(path, name):
        spec = importlib.util.spec_from_file_location(name, path)
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, name, module)
        spec.loader.exec_module(module)
        return module

    return plant


@pytest.mark.parametrize("bug", BUGS)
def test_a_planted_bug_is_found(bug, planted):
    report = fuzz(AbbCodec(planted(**BUGS[bug])), count=20_000, seed=1, seconds=60)
    assert report.findings


def test_the_codec_itself_has_none():
    report = fuzz(AbbCodec(), count=6_000, seed=2)
    assert report.findings == []
    assert report.inputs == 6_000


def test_there_are_twenty():
    assert len(BUGS) >= 20
