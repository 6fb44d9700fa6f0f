import asyncio
import re
from pathlib import Path

import pytest

import sims
from sims.rapid import library
from sims.rapid.builtin import BUILTINS
from sims.rapid.parser import parse_routine_head
from sims.rapid.types import TypeTable
from tests.sims.rapid.runtime.bench import Host, play, result, run, value


def test_every_error_that_a_built_in_raises_has_a_number():
    root = Path(sims.__file__).parent
    known = set(re.findall(r"ERR_\w+", (root / "rapid/prelude/errors.sys").read_text()))
    for path in [*root.glob("rapid/**/*.py"), *root.glob("controller/**/*.py")]:
        for name in re.findall(r'RapidError\(\s*"(ERR_\w+)"', path.read_text()):
            assert name in known, f"{path}: {name}"


def test_every_declaration_can_be_read_and_is_there_once():
    library.register()
    names = [parse_routine_head(one.declaration).name.lower() for one in BUILTINS]
    assert len(names) == len(set(names))
    assert TypeTable().find("clock") is not None


def test_clocks_run_stop_and_are_reset():
    program = """
        VAR clock watch;
        VAR string result;
        PROC main()
            ClkStart watch;
            WaitTime 1.2345;
            ClkStop watch;
            WaitTime 5;
            result := NumToStr(ClkRead(watch), 4);
            ClkStart watch;
            WaitTime 0.1;
            result := result + " " + NumToStr(ClkRead(watch \\HighRes), 3);
            ClkReset watch;
            result := result + " " + NumToStr(ClkRead(watch), 0);
        ENDPROC
    """
    assert result(program) == "1.2300 1.335 0"


def test_waiting_for_signals_ends_at_the_value_or_with_a_flag():
    program = """
        VAR bool late;
        VAR bool flag;
        VAR string result;
        PROC main()
            SetDO \\SDelay:=0.5, do1, 1;
            WaitDO do1, 1 \\MaxTime:=2 \\TimeFlag:=late;
            IF NOT late result := "in time ";
            WaitDO do2, 1 \\MaxTime:=0.1 \\TimeFlag:=late;
            IF late result := result + "late ";
            SetAO ao1, 3;
            WaitAO ao1 \\GT, 2.5;
            WaitUntil do1 = 1 AND ao1 = 3 \\PollRate:=0.05;
            WaitUntil FALSE \\MaxTime:=0.2 \\TimeFlag:=flag;
            IF flag result := result + "polled";
        ENDPROC
    """
    assert result(program) == "in time late polled"


def test_wait_until_sees_a_function_anew_each_time():
    program = """
        VAR num result;
        FUNC bool enough()
            result := result + 1;
            RETURN result >= 5;
        ENDFUNC
        PROC main()
            WaitUntil enough();
        ENDPROC
    """
    assert result(program) == 5


def test_the_operator_is_asked_and_told():
    program = """
        VAR num key;
        VAR num number;
        VAR btnres button;
        PROC main()
            TPErase;
            TPWrite "at " \\Pos:=[1, 2, 3];
            TPReadFK key, "Go?", "Yes", "No", "", "", "";
            TPReadNum number, "How many?";
            button := UIMessageBox(\\Message:="Sure?" \\Buttons:=btnYesNo);
            number := number + UINumEntry(\\Message:="More" \\MaxValue:=5);
        ENDPROC
    """
    host = Host()
    host.pendant.answers = [2, 12, 1, 9, 3]
    system = run(program, host=host)
    assert host.pendant.lines == ["at [1,2,3]"]
    assert [value(system, name) for name in ("key", "number", "button")] == [2, 15, 6]


def test_the_controller_is_asked_about_itself():
    program = """
        VAR string result;
        VAR num n;
        VAR num x;
        PROC main()
            result := GetSysInfo(\\LanIp) + GetSysInfo(\\SerialNo) + GetTaskName(\\TaskNo:=n);
            IF OpMode() = OP_AUTO AND RunMode() = RUN_CONT_CYCLE result := result + "!";
            ReadCfgData "/MOC/ARM_TYPE/robot_1", "x", x;
            result := result + ValToStr(n) + ValToStr(x);
            IF TaskRunRob() result := result + "r";
        ENDPROC
    """
    assert result(program) == "192.168.125.11200-1T_ROB1!14.5r"


def test_the_event_log_gets_what_programs_write():
    program = """
        PROC main()
            ErrWrite \\W, "Low air", "Open the valve" \\RL2:="or wait";
            ErrWrite \\I, "Note", "x";
            ErrRaise "ERR_DIVZERO", 17, "a", "", "", "", "";
        ERROR (ERR_DIVZERO)
            TRYNEXT;
        ENDPROC
    """
    entries = run(program).host.log.entries
    assert [(one.kind, one.number, one.title, one.cause) for one in entries] == [
        ("warning", 80001, "Low air", ("Open the valve", "or wait")),
        ("state", 80001, "Note", ("x",)),
        ("warning", 80017, "ERR_DIVZERO", ("a",)),
    ]


@pytest.mark.parametrize("pattern", ["(a+)+$", "[", ".*.*.*.*.*.*x", "+", "a" * 80])
def test_a_search_pattern_cannot_break_or_hang_the_machine(pattern):
    program = f"""
        VAR num result;
        VAR datapos at;
        VAR string name;
        PROC main()
            SetDataSearch "num" \\Object:="{pattern}";
            WHILE GetNextSym(name, at) DO
                result := result + 1;
            ENDWHILE
        ERROR
            TRYNEXT;
        ENDPROC
    """
    assert result(program) == 0


def test_delayed_outputs_are_dropped_when_the_program_starts_anew():
    program = "PROC main()\n SetDO \\SDelay:=1, do1, 1;\n Stop;\n ENDPROC"

    async def script(system):
        task = system.tasks["T_ROB1"]
        task.start()
        await task.stopped()
        task.pp_to_main()
        await asyncio.sleep(2)
        assert system.host.signals["do1"].value == 0

    play(script, program)
