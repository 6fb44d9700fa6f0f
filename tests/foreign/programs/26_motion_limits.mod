MODULE MotionLimits
    ! Where the robot cannot go, and how the program lives with it

    PERS tooldata tStick := [TRUE, [[0, 0, 160], [1, 0, 0, 0]], [0.4, [0, 0, 80], [1, 0, 0, 0], 0, 0, 0]];
    CONST robtarget pGood := [[450, 100, 350], [0, 0, 1, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
    CONST robtarget pFar := [[1400, 100, 350], [0, 0, 1, 0], [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
    CONST robtarget pFlip := [[450, 160, 350], [0, 0, 1, 0], [0, -2, 2, 1], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
    VAR jointtarget jFlip;
    VAR jointtarget jSame;
    VAR robtarget pRead;
    VAR clock ck;
    PERS string trace := "";
    PERS bool sign5{2} := [FALSE, FALSE];
    PERS num j4 := 0;
    PERS num tSlow := 0;
    PERS num tFast := 0;
    PERS pos conf146{2} := [[0, 0, 0], [0, 0, 0]];

    PROC main()
        trace := "";
        MoveJ pGood, v1000, fine, tStick;
        pRead := CRobT(\Tool := tStick \WObj := wobj0);
        conf146{1} := [pRead.robconf.cf1, 0, pRead.robconf.cf6];
        outside;
        flips;
        speeds;
        TPWrite trace;
        EXIT;
    ENDPROC

    PROC outside()
        jSame := CalcJointT(pFar, tStick);
        trace := trace + "o2 ";
    ERROR
        IF ERRNO = ERR_OUTSIDE_REACH OR ERRNO = ERR_ROBLIMIT THEN
            trace := trace + "o1 ";
            TRYNEXT;
        ENDIF
        RAISE;
    ENDPROC

    ! the same pose with the wrist the other way round: axis 4 half a turn, axis 5 negative
    PROC flips()
        jSame := CalcJointT(pGood, tStick);
        MoveJ pFlip, v1000, fine, tStick;
        jFlip := CJointT();
        sign5{1} := jSame.robax.rax_5 > 0;
        sign5{2} := jFlip.robax.rax_5 < 0;
        j4 := Abs(jFlip.robax.rax_4);
        pRead := CRobT(\Tool := tStick \WObj := wobj0);
        MoveJ pGood, v1000, fine, tStick;
    ENDPROC

    PROC speeds()
        ! 90 degrees at 30 degrees a second, whatever the way of the tip
        ClkReset ck;
        ClkStart ck;
        MoveJ RelTool(pGood, 0, 0, 0 \Rz := 60), [1000, 30, 5000, 1000], fine, tStick;
        ClkStop ck;
        tSlow := ClkRead(ck);
        ClkReset ck;
        ClkStart ck;
        VelSet 50, 5000;
        MoveL pGood, v1000, fine, tStick;
        MoveL Offs(pGood, 0, 100, 0), v100, fine, tStick;
        ClkStop ck;
        tFast := ClkRead(ck);
        VelSet 100, 5000;
    ENDPROC
ENDMODULE
