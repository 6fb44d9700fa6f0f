"""``binpick rapid check`` as it is typed."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cell.cli.rapid import app
from hal.errors import ConfigError


def ask(*words: str) -> tuple[int, str]:
    answer = CliRunner().invoke(app, ["check", *words], catch_exceptions=False)
    return answer.exit_code, answer.output


def test_an_error_is_a_line_with_its_place_the_source_and_a_caret(tmp_path: Path) -> None:
    path = tmp_path / "a.mod"
    path.write_text("MODULE a\n\tVAR num n := ;\nENDMODULE\n")
    status, text = ask(str(path))
    assert status == 1
    first, source, caret, summary = text.splitlines()
    assert first == f"{path}:2:15: error: expected a value, found ';'"
    assert source == "\tVAR num n := ;"
    assert caret == "\t" + " " * 13 + "^"
    assert summary == "1 files, 1 modules, 4 lines: 1 errors, 0 warnings"


def test_a_good_program_passes_and_warnings_do_not_fail(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/a.MODX").write_text("MODULE a\nPROC main()\nshared 1;\nx;\nENDPROC\nENDMODULE")
    (tmp_path / "b.sys").write_text("MODULE b(SYSMODULE)\nPROC shared(num n)\nENDPROC\nENDMODULE")
    (tmp_path / "model.mod").write_text("set I;\n")
    status, text = ask(str(tmp_path))
    assert status == 0
    assert "0 errors, 2 warnings" in text
    assert "procedure x is not known" in text
    assert "no MODULE here" in text


def test_a_backup_brings_its_tasks_and_signals(tmp_path: Path) -> None:
    files = {
        "BACKINFO/backinfo.txt": ">>TASK1: (T_ROB1,,)\nPROGMOD/a.mod @\n>>TASK2: (T_2,,)\n",
        "SYSPAR/SYS.cfg": 'SYS:CFG_1.0::\nCAB_TASKS:\n -Name "T_ROB1" -Type "NORMAL" -MotionTask\n'
        ' -Name "T_2" -Type "STATIC"\n',
        "SYSPAR/EIO.cfg": 'EIO:CFG_1.0::\nEIO_SIGNAL:\n -Name "di1" -SignalType "DI"\n',
        "RAPID/TASK1/PROGMOD/a.mod": "MODULE a\nPROC main()\nIF di1=1 AND di2=1 main;\n"
        "ENDPROC\nENDMODULE",
        "RAPID/TASK1/PROGMOD/old.mod": "MODULE a\nENDMODULE",
        "RAPID/TASK2/PROGMOD/b.mod": "MODULE b\nPROC main()\nENDPROC\nENDMODULE",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    out = tmp_path / "out.json"
    status, text = ask(str(tmp_path), "--json", str(out))
    assert status == 1
    found = json.loads(out.read_text())
    (error,) = found["diagnostics"]
    assert (error["line"], error["column"], error["severity"]) == (3, 14, "error")
    assert "di2 is not known" in error["message"]
    assert (found["files"], found["errors"]) == (2, 1)
    assert any("old.mod" in item for item in found["rest"])
    assert "old.mod" in text


def test_what_cannot_be_checked_is_one_error(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is not there"):
        ask(str(tmp_path / "none"))
    with pytest.raises(ConfigError, match=r"no \.mod \.sys"):
        ask(str(tmp_path))
    with pytest.raises(ConfigError, match="NORMAL, STATIC, SEMISTATIC"):
        ask(str(tmp_path), "--task-type", "ODD")
