MODULE Bridge
  ! SEMISTATIC task: lamp, watchdog, and a message for the robot task
  PERS num bgTurns:=0;
  PERS num order{3}:=[0,0,0];
  PERS bool stopOrder:=FALSE;
  PERS string bgError:="";
  VAR num served:=0;
  VAR intnum iOrder;

  PROC bridge()
    bgTurns:=0;
    served:=0;
    CONNECT iOrder WITH trOrder;
    IPers order,iOrder;
    WHILE TRUE DO
      bgTurns:=bgTurns+1;
      IF di1=1 AND do7=0 THEN
        SetDO do7,1;
      ELSEIF di1=0 AND do7=1 THEN
        SetDO do7,0;
      ENDIF
      WaitTime 0.05;
    ENDWHILE
  ERROR
    bgError:="error "+NumToStr(ERRNO,0);
    TRYNEXT;
  ENDPROC

  TRAP trOrder
    served:=served+1;
    IF order{1}=2 stopOrder:=TRUE;
  ENDTRAP
ENDMODULE
