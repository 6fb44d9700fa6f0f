MODULE FieldIdioms
  ! Wrappers and habits collected from three lines.   A. Novák, servis
  PERS tooldata tGun:=[TRUE,[[0,0,160],[1,0,0,0]],[1,[0,0,80],[1,0,0,0],0,0,0]];
  PERS wobjdata wJig:=[FALSE,TRUE,"",[[400,100,300],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  CONST robtarget pJig:=[[0,0,0],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR intnum iOnce;
  VAR intnum iBad;
  VAR errnum ERR_OWN:=-1;
  VAR num nTrap:=0;
  VAR robtarget pSeen;
  PERS string log:="";
  PERS string args{4}:=["","","",""];
  PERS pos seen{4}:=[[0,0,0],[0,0,0],[0,0,0],[0,0,0]];
  PERS robtarget parsed:=[[0,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PERS bool parsedOk:=FALSE;
  PERS num number:=0;

  PROC main()
    log:="";
    BookErrNo ERR_OWN;
    ConfL\Off;
    ConfJ\Off;
    wrappers;
    between;
    caller;
    longWay;
    byNumber;
    withTraps;
    parsing;
    leaveLoops;
    TPWrite log;
    EXIT;
  ENDPROC

  PROC add(string s)
    log:=log+s;
  ENDPROC

  ! the wrapper hands on what it was given
  PROC rMove(robtarget p,speeddata v,\zonedata z,PERS tooldata t\PERS wobjdata WObj\switch Jnt)
    VAR zonedata zUsed;
    zUsed:=fine;
    IF Present(z) zUsed:=z;
    IF Present(Jnt) THEN
      MoveJ p,v,zUsed,t\WObj?WObj;
    ELSE
      MoveL p,v,zUsed,t\WObj?WObj;
    ENDIF
  BACKWARD
    add "never";
  ERROR
    RAISE;
  ENDPROC

  PROC rSee(num i)
    pSeen:=CRobT(\Tool:=tGun\WObj:=wobj0);
    seen{i}:=pSeen.trans;
  ENDPROC

  PROC wrappers()
    rMove pJig,v1000,tGun\WObj:=wJig\Jnt;
    rSee 1;
    rMove Offs(pJig,0,50,0),v300\z:=z10,tGun,\WObj:=wJig;
    WaitRob\InPos;
    rSee 2;
    ! without a work object the same numbers are in wobj0
    rMove [[430,120,350],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v300,tGun;
    rSee 3;
    MoveL RelTool([[430,120,350],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],20,30,-40),v300,fine\Inpos:=inpos20,tGun;
    rSee 4;
  ENDPROC

  ! an optional argument between required ones
  PROC label(string s \num n,string e)
    IF Present(n) THEN
      add s+NumToStr(n,0)+e;
    ELSE
      add s+e;
    ENDIF
  ENDPROC

  PROC between()
    label "a","b ";
    label "a"\n:=7,"b ";
    label "a",\n:=8,"b ";
  ENDPROC

  ! an error in a handler goes to the caller
  PROC handlerFails()
    RAISE ERR_OWN;
  ERROR
    add "h1 ";
    number:=1/0;
    add "never";
  ENDPROC

  PROC caller()
    handlerFails;
    add "h3 ";
  ERROR
    IF ERRNO=ERR_DIVZERO add "h2 ";
    TRYNEXT;
  ENDPROC

  ! the long jump does not ask the handlers on its way
  PROC inner()
    RAISE ERR_OWN;
  ENDPROC

  PROC middle()
    inner;
    add "never";
  ERROR
    add "asked ";
    TRYNEXT;
  ENDPROC

  PROC longWay()
    middle;
    add "j2 ";
  ERROR (LONG_JMP_ALL_ERR)
    add "j1 ";
    TRYNEXT;
  ENDPROC

  ! numbers instead of names
  PROC byNumber()
    RAISE 30;
    add "n2 ";
  ERROR
    IF ERRNO=30 THEN
      add "n1 ";
      TRYNEXT;
    ENDIF
    RAISE;
  ENDPROC

  PROC withTraps()
    CONNECT iOnce WITH trOnce;
    ISignalDO\Single,do1,1,iOnce;
    Set do1;
    WaitTime 0.1;
    Reset do1;
    WaitTime 0.1;
    Set do1;
    WaitTime 0.1;
    add NumToStr(nTrap,0)+" ";
    ! a second CONNECT of one number is an error
    CONNECT iOnce WITH trOnce;
    add "never";
  ERROR
    IF ERRNO=ERR_ALRDYCNT THEN
      add "c ";
      IDelete iOnce;
      RETURN;
    ENDIF
    RAISE;
  ENDPROC

  TRAP trOnce
    nTrap:=nTrap+1;
    number:=1/0;
    nTrap:=nTrap+10;
  ERROR
    TRYNEXT;
  ENDTRAP

  PROC parsing()
    VAR string s;
    s:="[[1.5,-2,3E2],[0,0,1,0],[-1,0,-1,0],";
    parsedOk:=StrToVal(s+"[9E9,9E9,9E9,9E9,9E9,9E9]]",parsed);
    IF NOT StrToVal(s,parsed) add "p ";
  ENDPROC

  PROC leaveLoops()
    VAR num n:=0;
    FOR i FROM 1 TO 5 DO
      WHILE TRUE DO
        n:=n+1;
        IF n=4 GOTO away;
        IF n MOD 2=0 GOTO nextOne;
      ENDWHILE
    nextOne:
    ENDFOR
  away:
    add "g"+NumToStr(n,0);
  ENDPROC
ENDMODULE
