MODULE HelperTask
  ! task T_HELP, without motion
  PERS tasks bothTasks{2}:=[["T_ROB1"],["T_HELP"]];
  VAR syncident syncBegin;
  VAR syncident syncMiddle;
  VAR syncident syncEnd;

  ! no values here: those of the other task hold
  PERS bool lock;
  PERS num shared;
  PERS num ping;
  PERS num pong;
  PERS bool helperMay;
  PERS string mailbox;
  VAR num mine:=0;

  PROC main()
    WaitSyncTask syncBegin,bothTasks;
    WHILE mine<100 DO
      WHILE TestAndSet(lock)=FALSE DO
      ENDWHILE
      shared:=shared+1;
      mine:=mine+1;
      lock:=FALSE;
    ENDWHILE

    FOR i FROM 1 TO 20 DO
      WHILE ping<>i DO
      ENDWHILE
      pong:=ping;
    ENDFOR

    WaitUntil helperMay=TRUE;
    WaitTime 2;
    WaitSyncTask syncMiddle,bothTasks;
    mailbox:="shared is "+NumToStr(shared,0)+", mine "+ValToStr(mine);
    WaitSyncTask syncEnd,bothTasks;
    EXIT;
  ENDPROC
ENDMODULE
