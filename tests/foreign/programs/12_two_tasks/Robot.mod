MODULE RobotTask
  ! task T_ROB1: moves and shares a counter with T_HELP
  PERS tasks bothTasks{2}:=[["T_ROB1"],["T_HELP"]];
  VAR syncident syncBegin;
  VAR syncident syncMiddle;
  VAR syncident syncEnd;

  PERS bool lock:=FALSE;
  PERS num shared:=0;
  PERS num ping:=0;
  PERS num pong:=0;
  PERS num torn:=0;
  PERS bool helperMay:=FALSE;
  PERS string mailbox:="";
  PERS num middleAt{2}:=[0,0];
  VAR num mine:=0;
  VAR clock watch;

  CONST jointtarget jHere:=[[10,0,10,0,60,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget jThere:=[[-10,5,10,0,60,30],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC main()
    shared:=0;
    ping:=0;
    pong:=0;
    torn:=0;
    lock:=FALSE;
    mailbox:="";
    helperMay:=FALSE;
    WaitSyncTask syncBegin,bothTasks;

    FOR i FROM 1 TO 100 DO
      addOne;
    ENDFOR

    ! ping-pong by polling, no waits at all
    FOR i FROM 1 TO 20 DO
      ping:=i;
      WHILE pong<>i DO
      ENDWHILE
    ENDFOR

    MoveAbsJ jHere,v1000,fine,tool0;
    ClkStart watch;
    MoveAbsJ jThere,v1000,fine,tool0;
    helperMay:=TRUE;
    WaitSyncTask syncMiddle,bothTasks\TimeOut:=20;
    middleAt{1}:=ClkRead(watch);
    WaitUntil mailbox<>"";
    TPWrite mailbox;
    WaitSyncTask syncEnd,bothTasks;
    EXIT;
  ENDPROC

  PROC addOne()
    VAR num before;
    WaitTestAndSet lock;
    before:=shared;
    mine:=mine+1;
    shared:=before+1;
    lock:=FALSE;
  ENDPROC
ENDMODULE
