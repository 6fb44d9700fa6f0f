"""The probe programs run, and the table says what the interpreter answers."""

import tomllib
from pathlib import Path

import pytest

from sims.rapid import library
from sims.rapid.builtin import TaskKind
from sims.rapid.check import check
from sims.rapid.errors import Severity
from sims.rapid.parser import parse_file
from tests.sims.rapid.runtime.bench import Host, run

PROBES = Path(__file__).parents[3] / "drivers/abb/probes"
SOURCES = [*sorted(PROBES.glob("*.sys")), *sorted(PROBES.glob("*.mod"))]


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    home = tmp_path_factory.mktemp("home")
    host = Host(home=home)
    host.info["swversion"] = "simulated"
    system = run("\n".join(path.read_text() for path in SOURCES), host=host)
    assert not system.tasks["T_ROB1"].has_failed, host.log.entries
    assert [path.name for path in home.iterdir()] == ["bpprobe.txt"]
    lines = (home / "bpprobe.txt").read_text().splitlines()
    assert lines[0] == "software: simulated"
    assert lines[-1] == "end: reached"
    return dict(line.split(": ", 1) for line in lines[1:-1])


def test_the_table_has_every_answer_of_the_interpreter(answers: dict[str, str]) -> None:
    table = tomllib.loads((PROBES / "expected.toml").read_text())
    assert {fact: row["ours"] for fact, row in table.items()} == answers


def test_the_interpreter_answers_as_expected_wherever_something_is() -> None:
    table = tomllib.loads((PROBES / "expected.toml").read_text())
    differing = {f: row for f, row in table.items() if row["expected"] not in ("", row["ours"])}
    assert differing == {}


def test_the_probes_pass_the_check_and_need_neither_motion_nor_signals() -> None:
    library.register()
    modules = [module for path in SOURCES for module in parse_file(path)[0]]
    found = check(modules, kind=TaskKind.STATIC, has_motion=False, signals=[])
    assert [str(item) for item in found if item.severity is Severity.ERROR] == []
    assert len(modules) == len(SOURCES)
