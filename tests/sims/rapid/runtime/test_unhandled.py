import asyncio

import pytest

from tests.sims.rapid.runtime.bench import play, result, run, value

TRACE = """
    VAR string trace;
    PROC note(string text)
        trace := trace + text;
    ENDPROC
"""


def trace(text):
    return result(TRACE + text, "trace")


def test_an_unhandled_error_stops_all_normal_tasks_and_says_where():
    other = "PROC main()\n WHILE TRUE DO\n WaitTime 0.1;\n ENDWHILE\n ENDPROC"
    failing = """
        VAR num zero;
        PROC main()
            WaitTime 1;
            inner;
        ENDPROC
        PROC inner()
            zero := 1 / zero;
        ENDPROC
    """

    async def script(system):
        first, second = system.tasks.values()
        first.start()
        second.start()
        await first.stopped()
        await second.stopped()
        assert first.has_failed
        assert not second.has_failed
        assert str(first.pointer) == "Bench/inner, line 9"
        assert [str(one) for one in first.stack] == ["Bench/main, line 6", "Bench/inner, line 9"]
        (entry,) = system.host.log.entries
        assert entry.title == "Unhandled error ERR_DIVZERO"
        assert entry.cause == (
            "Task T_ROB1", "Program ref. Bench/inner, line 9", "division by zero",
        )  # fmt: skip

    play(script, failing, other)


def test_a_start_after_an_error_executes_the_failed_statement_again():
    program = """
        PERS num divisor := 0;
        VAR num result;
        PROC main()
            result := result + 1 / divisor;
            Stop;
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]
        task.start()
        await task.stopped()
        assert task.has_failed
        system.find("T_ROB1", "divisor").set(4.0)
        task.start()
        await task.stopped()
        assert not task.has_failed
        assert value(system, "result") == 0.25

    play(script, program)


def test_booked_numbers_are_raised_and_told_apart():
    program = """
        VAR errnum first := -1;
        VAR errnum second := -1;
        PROC main()
            BookErrNo first;
            BookErrNo second;
            inner first;
            inner second;
        ERROR
            IF ERRNO = first note "first ";
            IF ERRNO = second note "second";
            TRYNEXT;
        ENDPROC
        PROC inner(errnum number)
            RAISE number;
        ENDPROC
    """
    assert trace(program) == "first second"


def test_a_clause_can_list_a_booked_number():
    program = """
        VAR errnum mine := -1;
        PROC main()
            BookErrNo mine;
            RAISE mine;
        ERROR (mine)
            note "mine";
            TRYNEXT;
        ERROR
            note "other";
        ENDPROC
    """
    assert trace(program) == "mine"


def test_calls_of_what_is_not_there_are_errors_only_when_they_are_reached():
    program = """
        VAR num a;
        VAR bool never;
        PROC main()
            IF never nosuch [1, 2, 3];
            IF never a := 1 + nofunc(2);
            nosuch [1, 2, 3], a;
            a := nofunc(2);
            note "end";
        ERROR (ERR_REFUNKPRC)
            note "x";
            TRYNEXT;
        ENDPROC
    """
    assert trace(program) == "xxend"


def test_exit_undoes_loses_the_pointer_and_exitcycle_begins_again():
    program = """
        PERS num cycles := 0;
        PERS string trace := "";
        VAR num count;
        PROC main()
            cycles := cycles + 1;
            count := count + 1;
            inner;
        ENDPROC
        PROC inner()
            IF cycles < 3 ExitCycle;
            trace := trace + ValToStr(count);
            EXIT;
        UNDO
            trace := trace + "u";
        ENDPROC
    """

    async def script(system):
        task = system.tasks["T_ROB1"]
        task.start(is_cyclic=True)
        while task.is_running:
            await task.stopped()
        assert value(system, "trace") == "uu3u"
        assert task.pointer is None
        task.pp_to_main()
        assert task.pointer.routine == "main"

    play(script, program)


@pytest.mark.parametrize(
    ("statement", "name"),
    [
        ("a := 1 / zero;", "ERR_DIVZERO"),
        ("a := 5 MOD zero;", "ERR_DIVZERO"),
        ("a := 5 DIV zero;", "ERR_DIVZERO"),
        ("b{4} := 1;", "ERR_OUTOFBND"),
        ("b{0} := 1;", "ERR_OUTOFBND"),
        ("a := b{1.5};", "ERR_OUTOFBND"),
        ("s := s + s;", "ERR_STRTOOLNG"),
        ("a := 3E38 * 10;", "ERR_NUM_LIMIT"),
        ("WaitUntil FALSE \\MaxTime:=0.5;", "ERR_WAIT_MAXTIME"),
        ("WaitDI di1, 1 \\MaxTime:=0.5;", "ERR_WAIT_MAXTIME"),
        ("IWatch id;", "ERR_UNKINO"),
        ("a := Dim(b, 2);", "ERR_ILLDIM"),
        ("GetDataVal \"nosuch\", a;", "ERR_SYM_ACCESS"),
        ("GetDataVal \"s\", a;", "ERR_SYMBOL_TYPE"),
        ("SocketListen sock;", "ERR_SOCK_CLOSED"),
        ("SocketBind made, \"10.1.1.1\", 1025;", "ERR_SOCK_ADDR_INVALID"),
        ("a := SocketPeek(made);", "ERR_SOCK_NOT_CONN"),
        ("SetDO led, 1;", "ERR_NO_ALIASIO_DEF"),
        ("AliasIO \"nosuch\", led;", "ERR_ALIASIO_DEF"),
        ("AliasIO \"di1\", led;", "ERR_ALIASIO_TYPE"),
        ("ReadCfgData \"no/such\", \"x\", a;", "ERR_CFG_NOTFND"),
        ("TPReadNum a, \"?\" \\MaxTime:=0.1;", "ERR_TP_MAXTIME"),
        ("CONNECT taken WITH tr;", "ERR_ALRDYCNT"),
        ("ITimer 0.001, taken;", "ERR_ARGVALERR"),
    ],
)  # fmt: skip
def test_each_mistake_has_its_error(statement, name):
    program = f"""
        VAR num result;
        VAR num zero;
        VAR num a;
        VAR num b{{3}};
        VAR string s := "0123456789012345678901234567890123456789012345678901234567890";
        VAR intnum id;
        VAR intnum taken;
        VAR socketdev sock;
        VAR socketdev made;
        VAR signaldo led;
        TRAP tr
        ENDTRAP
        PROC main()
            CONNECT taken WITH tr;
            SocketCreate made;
            {statement}
        ERROR ({name})
            result := 1;
            TRYNEXT;
        ENDPROC
    """
    assert result(program) == 1


def test_recursion_is_bounded():
    system = run("PROC main()\n main;\n ENDPROC")
    assert system.tasks["T_ROB1"].has_failed
    assert "too deeply" in system.host.log.entries[0].cause[2]


def test_a_function_without_return_is_fatal_for_the_program():
    system = run(
        """
        VAR bool go;
        FUNC num f()
            IF go RETURN 1;
        ENDFUNC
        PROC main()
            VAR num a;
            a := f();
        ERROR
            TRYNEXT;
        ENDPROC
        """
    )
    assert system.tasks["T_ROB1"].has_failed


@pytest.mark.parametrize("after_us", range(950, 1150, 10))
def test_a_stop_while_exitcycle_goes_to_main_is_not_lost(after_us):
    async def script(system):
        (task,) = system.tasks.values()
        task.start()
        await asyncio.sleep(after_us / 1e6)
        task.stop()
        await asyncio.sleep(0.01)
        assert not task.is_running
        task.pp_to_main()

    play(script, "PROC main()\n WHILE TRUE DO\n ExitCycle;\n ENDWHILE\nENDPROC")
