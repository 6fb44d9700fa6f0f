MODULE PressMain
  !------------------------------------------------------------
  ! Press line 2, robot.  Loads three blanks, then a check by
  ! the watch task, which runs whether or not this one does.
  !------------------------------------------------------------
  CONST num N_BLANKS:=3;
  VAR num axis6:=0;
  PERS string system:="";

  PROC main()
    shiftParts:=0;
    requestCheck:=FALSE;
    checkResult:=0;
    rHome;
    TPWrite "waiting for start";
    WaitDI diStart,1;
    FOR i FROM 1 TO N_BLANKS DO
      rLoad i;
    ENDFOR
    SetGO goCode,0;
    rCheck;
    rHome;
    SetDO doReady,1;
    EXIT;
  ENDPROC

  PROC rHome()
    VAR jointtarget j;
    MoveAbsJ jWide\NoEOffs,v1500,fine,tool0;
    j:=CJointT();
    axis6:=Round(j.robax.rax_6);
  ENDPROC

  PROC rLoad(num n)
    ConfL\Off;
    ConfJ\Off;
    SetGO goCode,n;
    MoveJ Offs(pPress,0,0,60),v1500,z20,tPad\WObj:=wobjPress;
    MoveL pPress,v800,fine,tPad\WObj:=wobjPress;
    Count;
    MoveL Offs(pPress,0,0,60),v800,z20,tPad\WObj:=wobjPress;
    MoveL pOut,v800,fine,tPad\WObj:=wobjPress;
    WaitUntil goCode=n;
  ENDPROC

  PROC rCheck()
    requestCheck:=TRUE;
    WaitUntil requestCheck=FALSE\MaxTime:=5;
    TPWrite "check: "\Num:=checkResult;
  ERROR
    IF ERRNO=ERR_WAIT_MAXTIME THEN
      TPWrite "no answer from the watch task";
      TRYNEXT;
    ENDIF
  ENDPROC
ENDMODULE
