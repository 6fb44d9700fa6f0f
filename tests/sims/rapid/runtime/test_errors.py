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


def test_trynext_goes_on_behind_the_failed_statement():
    program = """
        VAR num a;
        PROC main()
            note "a";
            a := 1 / a;
            note "b";
        ERROR
            IF ERRNO = ERR_DIVZERO THEN
                note "!";
                TRYNEXT;
            ENDIF
        ENDPROC
    """
    assert trace(program) == "a!b"


def test_retry_repeats_the_failed_statement_from_its_start():
    program = """
        VAR num a{3};
        VAR num k := 5;
        FUNC num next()
            note "n";
            RETURN 7;
        ENDFUNC
        PROC main()
            a{k} := next();
            note "b";
        ERROR
            note "!";
            k := 3;
            RETRY;
        ENDPROC
    """
    assert trace(program) == "n!nb"


def test_an_error_goes_to_the_caller_whose_statement_is_the_call():
    program = """
        PROC main()
            inner;
            note "after";
        ERROR
            note "main ";
            TRYNEXT;
        ENDPROC
        PROC inner()
            VAR num x;
            deeper;
            note "never";
        ENDPROC
        PROC deeper()
            RAISE 17;
        ERROR (ERR_DIVZERO)
            note "wrong";
        ENDPROC
    """
    assert trace(program) == "main after"


def test_raise_passes_an_error_on_and_errno_keeps_its_number():
    program = """
        PROC main()
            inner;
        ERROR (17)
            note "main";
            note ValToStr(ERRNO);
            TRYNEXT;
        ENDPROC
        PROC inner()
            RAISE 17;
        ERROR
            note "inner ";
            RAISE;
        ENDPROC
    """
    assert trace(program) == "inner main17"


def test_an_error_in_a_handler_goes_to_the_caller():
    program = """
        VAR num zero;
        PROC main()
            inner;
            note "after";
        ERROR
            IF ERRNO = ERR_DIVZERO note "div ";
            TRYNEXT;
        ENDPROC
        PROC inner()
            RAISE 17;
        ERROR
            note "inner ";
            zero := 1 / zero;
            note "never";
        ENDPROC
    """
    assert trace(program) == "inner div after"


def test_a_long_jump_passes_by_the_handlers_in_between_and_undoes():
    program = """
        PROC main()
            middle;
            note "after";
        ERROR (LONG_JMP_ALL_ERR)
            note "main ";
            TRYNEXT;
        ENDPROC
        PROC middle()
            inner;
            note "never";
        ERROR
            note "wrong";
        UNDO
            note "undo ";
        ENDPROC
        PROC inner()
            RAISE 17;
        ENDPROC
    """
    assert trace(program) == "undo main after"


def test_the_first_clause_that_lists_the_error_is_taken():
    program = """
        PROC main()
            VAR num numbers{2};
            FOR i FROM 1 TO 3 DO
                IF i = 1 RAISE 17;
                IF i = 2 numbers{9} := 1;
                IF i = 3 nosuch;
            ENDFOR
        ERROR (17, 18)
            note "user ";
            TRYNEXT;
        ERROR (ERR_OUTOFBND)
            note "bounds ";
            TRYNEXT;
        ERROR
            note "rest";
            TRYNEXT;
        ENDPROC
    """
    assert trace(program) == "user bounds rest"


def test_return_in_a_handler_leaves_the_routine_with_its_value():
    program = """
        VAR num zero;
        FUNC num safe()
            RETURN 1 / zero;
        ERROR
            RETURN -1;
        ENDFUNC
        PROC main()
            note ValToStr(safe());
        ENDPROC
    """
    assert trace(program) == "-1"


def test_the_end_of_a_handler_leaves_the_routine():
    program = """
        PROC main()
            inner;
            note "after";
        ENDPROC
        PROC inner()
            RAISE 17;
            note "never";
        ERROR
            note "handled ";
        ENDPROC
    """
    assert trace(program) == "handled after"


def test_retry_gives_up_after_four_times_unless_the_count_is_reset():
    limited = """
        VAR num tries;
        PROC main()
            inner;
        ERROR
            IF ERRNO = ERR_EXCRTYMAX note "max";
            TRYNEXT;
        ENDPROC
        PROC inner()
            nosuch;
        ERROR
            tries := tries + 1;
            RETRY;
        ENDPROC
    """
    system = run(TRACE + limited)
    assert value(system, "trace") == "max"
    assert value(system, "tries") == 5
    free = """
        VAR num result;
        PROC main()
            IF result < 20 THEN
                nosuch;
            ENDIF
        ERROR
            result := result + 1;
            IF result = 20 TRYNEXT;
            ResetRetryCount;
            RETRY;
        ENDPROC
    """
    assert result(free) == 20


def test_the_retry_count_begins_anew_when_the_statement_has_succeeded():
    program = """
        VAR num result;
        VAR num zero;
        VAR num a;
        PROC main()
            FOR i FROM 1 TO 10 DO
                zero := 0;
                a := 1 / zero;
            ENDFOR
        ERROR
            result := result + 1;
            zero := 1;
            RETRY;
        ENDPROC
    """
    assert result(program) == 10


def test_a_missing_procedure_is_a_recoverable_error_also_by_late_binding():
    program = """
        PROC main()
            nosuch 1, "x";
            %"no" + "such"%;
            CallByVar "nosuch", 3;
        ERROR
            IF ERRNO = ERR_REFUNKPRC note "x";
            TRYNEXT;
        ENDPROC
    """
    assert trace(program) == "xxx"


def test_late_binding_passes_values_references_and_options():
    program = """
        VAR num a := 1;
        PROC twice(INOUT num x, num by \\switch loud)
            x := x * by;
            IF Present(loud) note "!";
        ENDPROC
        PROC part2()
            note "two";
        ENDPROC
        PROC main()
            VAR num b := 4;
            %"twice"% a, 3 \\loud;
            %"TWICE"% b, 2;
            CallByVar "part", 2;
            note ValToStr(a) + ValToStr(b);
        ENDPROC
    """
    assert trace(program) == "!two38"


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
