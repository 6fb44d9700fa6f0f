"""Configuration files: what counts, what is left out, and that nothing hurts."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from sims.controller.cfg import lookup, parse_cfg


def test_values_are_text_numbers_flags_and_lists() -> None:
    cfg, wrong = parse_cfg(
        'X:CFG_1.0:6:1::\n#\nSEC:\n -Name "a b" -N -5.5E2 -T TRUE -Flag -V 1 "2" x -Q ""\n', "x.cfg"
    )
    assert not wrong
    attributes = cfg.section("sec")[0].attributes
    assert attributes == {
        "Name": "a b",
        "N": -550.0,
        "T": True,
        "Flag": True,
        "V": (1.0, "2", "x"),
        "Q": "",
    }


def test_a_line_is_carried_on_behind_a_backslash_and_errors_are_located_in_it() -> None:
    cfg, wrong = parse_cfg('X:CFG_1.0::\nSEC:\n -Name "a" \\\n   -B "open\n -Name "b"\n', "x.cfg")
    assert [item.name for item in cfg.section("SEC")] == ["a", "b"]
    assert [(d.at.line, d.at.column) for d in wrong] == [(4, 7)]


def test_readcfgdata_finds_an_instance_by_its_path() -> None:
    cfg, _ = parse_cfg('EIO:CFG_1.0::\nEIO_SIGNAL:\n -Name "di1" -SignalType "DI"\n', "EIO.cfg")
    assert lookup({"EIO": cfg}, "/EIO/EIO_SIGNAL/DI1", "signaltype") == "DI"
    for path, name in (("/EIO/EIO_SIGNAL/no", "x"), ("/MOC/A/b", "x"), ("", ""), ("/EIO", "x")):
        with pytest.raises(KeyError):
            lookup({"EIO": cfg}, path, name)


PIECES = [
    "EIO:CFG_1.0::\n",
    "#\n",
    "SEC:\n",
    "-Name",
    ' "x"',
    '"',
    "\\\n",
    " -",
    "1e999",
    "nan",
    "-5",
    "\x00",
]


@given(st.lists(st.one_of(st.sampled_from(PIECES), st.text(max_size=4))).map("".join))
@example("X:CFG_1.0::\nS:\n -A " + "1 " * 9 + '"')
def test_any_text_is_a_configuration_or_located_errors(text: str) -> None:
    cfg, wrong = parse_cfg(text, "x.cfg")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").count("\n") + 1
    assert all(1 <= d.at.line <= lines and d.at.column >= 1 for d in wrong)
    assert cfg.domain or wrong
