MODULE BELT (NOSTEPIN)
  !/// belt without encoder: position = speed * time
  !/// uses the clocks and registers every task has
  CONST num BELT_MM_S:=80;
  CONST num PITCH_MM:=40;
  VAR clock ckBelt;
  VAR num beltPos;
  VAR num nextPick:=0;
  PERS num picks:=0;
  PERS num loops:=0;
  PERS num elapsed:=0;
  PERS num stoppedAt{3}:=[0,0,0];
  PERS num fineTime:=0;
  PERS string today:="";
  PERS string nowText:="";
  PERS num regSum:=0;
  PERS tooldata tBelt:=[TRUE,[[0,0,160],[1,0,0,0]],[1,[0,0,80],[1,0,0,0],0,0,0]];
  CONST robtarget pBelt:=[[450,40,330],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC main()
    picks:=0; loops:=0; nextPick:=0;
    clocks;
    ConfL \Off;
    MoveJ Offs(pBelt,0,0,50),v1000,fine,tBelt;
    ClkReset ckBelt;
    ClkStart ckBelt;
    WHILE TRUE DO
      beltPos:=BELT_MM_S*ClkRead(ckBelt);
      IF beltPos>=nextPick THEN
        follow;
        IF picks>=3 GOTO finished;
      ENDIF
      WaitTime .05;
      loops:=loops+1;
    ENDWHILE
  finished:
    ClkStop ckBelt;
    elapsed:=ClkRead(ckBelt);
    TPWrite "picks "\Num:=picks;
    EXIT;
  ENDPROC

  PROC follow()
    VAR num ahead;
    ahead:=nextPick MOD 120;
    MoveL Offs(pBelt,0,ahead,0),v500,fine,tBelt;
    PulseDO \PLength:=0.05, do2;
    MoveL Offs(pBelt,0,ahead,50),v500,fine,tBelt;
    Incr picks;
    ! the next one after this is three pitches on
    nextPick:=nextPick+3*PITCH_MM+PITCH_MM;
  ENDPROC

  PROC clocks()
    ! a clock runs on, stops, and keeps its time until it is reset
    ClkReset clock1;
    ClkStart clock1;
    WaitTime 0.5;
    ClkStop clock1;
    stoppedAt{1}:=ClkRead(clock1);
    WaitTime 0.3;
    stoppedAt{2}:=ClkRead(clock1);
    ClkStart clock1;
    WaitTime 0.25;
    ClkStop clock1;
    stoppedAt{3}:=ClkRead(clock1);
    fineTime:=ClkRead(clock1 \HighRes);
    reg1:=2;
    reg2:=3;
    reg5:=reg1*reg2;
    regSum:=reg1+reg2+reg5;
    today:=CDate();
    nowText:=CTime();
    IF StrLen(today)<>10 OR StrPart(today,5,1)<>"-" today:="?";
    IF StrLen(nowText)<>8 OR StrPart(nowText,3,1)<>":" nowText:="?";
  ENDPROC
ENDMODULE
