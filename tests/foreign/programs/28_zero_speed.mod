MODULE WristTurns
    ! axis 6 counts its turns; the last point is a corner, so wait for standstill
    CONST jointtarget jTurn := [[0, 0, 0, 0, 30, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
    PERS num axis6{2} := [0, 0];

    PROC main()
        turns 1;
        MoveAbsJ jTurn, vmax, fine, tool0;
        turns 2;
        EXIT;
    ENDPROC

    PROC turns(num run)
        VAR jointtarget j;
        j := jTurn;
        FOR i FROM 1 TO 3 DO
            j.robax.rax_6 := j.robax.rax_6 + 100;
            MoveAbsJ j, vmax, z50, tool0;
        ENDFOR
        IF run = 1 THEN
            WaitRob \InPos;
        ELSE
            WaitRob \ZeroSpeed;
        ENDIF
        j := CJointT();
        axis6{run} := Round(j.robax.rax_6);
    ENDPROC
ENDMODULE
