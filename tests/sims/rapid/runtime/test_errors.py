from tests.sims.rapid.runtime.bench import result, run, value

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
