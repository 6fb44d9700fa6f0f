MODULE Watch
  PERS bool requestCheck;
  PERS num partsTotal;
  PERS num checkResult;
  PERS bool lampSeen;
  VAR num turns:=0;

  PROC watchMain()
    WHILE TRUE DO
      turns:=turns+1;
      ! the lamp follows the input
      SetDO doLamp,diStart;
      IF doLamp=1 lampSeen:=TRUE;
      IF requestCheck THEN
        checkResult:=partsTotal*10+goCode;
        requestCheck:=FALSE;
      ENDIF
      WaitTime 0.02;
    ENDWHILE
  ENDPROC
ENDMODULE
