MODULE ErrRecovery
    ! how errors travel: collected in one trace string
    VAR errnum ERR_GRIPPER := -1;
    VAR errnum ERR_SENSOR := -1;
    VAR errnum ERR_DEEP := -1;
    PERS string trace := "";
    PERS num tries := 0;
    PERS num divisor := 0;
    PERS num quotient := 0;
    PERS bool booked := FALSE;
    PERS num safe := 0;

    PROC main()
        trace := "";
        tries := 0;
        divisor := 0;
        BookErrNo ERR_GRIPPER;
        BookErrNo ERR_SENSOR;
        BookErrNo ERR_DEEP;
        booked := ERR_GRIPPER <> ERR_SENSOR AND ERR_SENSOR <> ERR_DEEP AND ERR_DEEP > 0;

        retried;
        skipped;
        raised;
        listed;
        safe := guarded(0) + guarded(4);
        jumped;
        missing;
        TPWrite trace;
        EXIT;
    ENDPROC

    PROC note(string what)
        trace := trace + what + " ";
    ENDPROC

    ! RETRY repeats the failing statement only
    PROC retried()
        note "r";
        quotient := 12 / divisor;
        note "R";
    ERROR
        IF ERRNO = ERR_DIVZERO THEN
            Incr tries;
            IF tries = 3 divisor := 4;
            RETRY;
        ENDIF
    ENDPROC

    ! TRYNEXT goes on behind it
    PROC skipped()
        VAR num n := 7;
        n := 1 DIV 0;
        note "s" + NumToStr(n, 0);
    ERROR
        TRYNEXT;
    ENDPROC

    PROC gripper()
        RAISE ERR_GRIPPER;
        note "never";
    ERROR
        IF ERRNO = ERR_GRIPPER THEN
            note "g1";
            RAISE;
        ENDIF
    ENDPROC

    PROC raised()
        gripper;
        note "g3";
    ERROR
        IF ERRNO = ERR_GRIPPER THEN
            note "g2";
            TRYNEXT;
        ENDIF
    ENDPROC

    ! a list of numbers; others are passed on
    PROC sensor(num which)
        IF which = 1 RAISE ERR_SENSOR;
        IF which = 2 RAISE ERR_GRIPPER;
        note "l0";
    ENDPROC

    PROC listInner(num which)
        sensor which;
        note "li";
    ERROR (ERR_SENSOR)
        note "l" + NumToStr(which, 0);
        RETURN;
    ENDPROC

    PROC listed()
        listInner 0;
        listInner 1;
        listInner 2;
        note "lx";
    ERROR (ERR_GRIPPER, ERR_DIVZERO)
        note "lo";
        TRYNEXT;
    ENDPROC

    ! an error in a function: the handler gives the value
    FUNC num guarded(num d)
        RETURN 8 / d;
    ERROR
        IF ERRNO = ERR_DIVZERO RETURN 100;
        RAISE;
    ENDFUNC

    ! a long jump over two levels; their UNDO clauses run, the innermost first
    PROC deep2()
        RAISE ERR_DEEP;
        note "never";
    UNDO
        note "u2";
    ENDPROC

    PROC deep1()
        deep2;
        note "never";
    UNDO
        note "u1";
    ENDPROC

    PROC jumped()
        deep1;
        note "j2";
    ERROR (LONG_JMP_ALL_ERR)
        note "j1";
        TRYNEXT;
    ENDPROC

    PROC missing()
        VAR string name := "rNotThere";
        %name%;
        note "m2";
    ERROR
        IF ERRNO = ERR_REFUNKPRC THEN
            note "m1";
            TRYNEXT;
        ENDIF
    ENDPROC
ENDMODULE
