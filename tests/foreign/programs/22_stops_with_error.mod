MODULE DeepError
   ! What an operator sees when nobody has thought of it: the error travels up
   ! through all handlers that do not want it, and the task stops.
   PERS num level:=0;
   PERS num limit{3}:=[10,20,30];
   PERS bool cleaned:=FALSE;
   PERS bool after:=FALSE;
   VAR num n:=0;
   CONST jointtarget jStart:=[[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
   CONST jointtarget jNext:=[[21,-10,-20,30,40,50],[9E9,9E9,9E9,9E9,9E9,9E9]];

   PROC main()
      level:=0;
      cleaned:=FALSE;
      after:=FALSE;
      MoveAbsJ jStart,v1000,fine,tool0;
      MoveAbsJ jNext,v1000,fine,tool0;
      SetDO do6,1;
      First;
      after:=TRUE;
      EXIT;
   ENDPROC

   PROC First()
      level:=level+1;
      Second 4;
      after:=TRUE;
   ERROR
      level:=level+10;
      IF ERRNO=ERR_DIVZERO TRYNEXT;
      RAISE;
   ENDPROC

   PROC Second(num index)
      level:=level+1;
      n:=Third(index);
      after:=TRUE;
   ERROR (ERR_SOCK_CLOSED,ERR_SOCK_TIMEOUT)
      level:=-1;
      TRYNEXT;
   ENDPROC

   FUNC num Third(num index)
      level:=level+1;
      ! there are only three limits
      RETURN limit{index};
   ERROR
      cleaned:=TRUE;
      SetDO do6,0;
      RAISE;
   ENDFUNC
ENDMODULE
