MODULE Interrupts
!======================================================================
! PURPOSE : part transfer that is broken off when the part is lost
! di1     : vacuum lost      di2 : operator call
!======================================================================

VAR intnum intLost;
VAR intnum intCall;
VAR intnum intTick;
VAR intnum intOnce;
VAR intnum intLevel;
VAR errnum ERR_PARTLOST:=-1;

PERS num nLost:=0;
PERS num nCalls:=0;
PERS num nTicks:=0;
PERS num nOnce:=0;
PERS num nLevel:=0;
PERS num nLevelSeen:=0;
PERS num nCallsQuiet:=-1;
PERS num nCallsAfter:=-1;
PERS num nTicksAsleep:=-1;
PERS num yWhereLost:=9999;
PERS bool bDone:=FALSE;

PERS tooldata tCup:=[TRUE,[[0,0,160],[1,0,0,0]],[0.9,[0,0,70],[1,0,0,0],0,0,0]];
CONST robtarget pLeft:=[[480,-180,320],[0,0,1,0],[-1,0,-1,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
CONST robtarget pRight:=[[480,200,320],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

PROC main()
    nLost:=0; nCalls:=0; nTicks:=0; nOnce:=0; nLevelSeen:=0; bDone:=FALSE;
    BookErrNo ERR_PARTLOST;
    setupInterrupts;
    ConfJ \Off;
    ConfL \Off;
    MoveJ pLeft,v1000,fine,tCup;

    transfer;
    quietPart;
    levelPart;
    timerPart;

    IDelete intLost;
    IDelete intCall;
    bDone:=TRUE;
    TPWrite "finished";
    EXIT;
ENDPROC

PROC setupInterrupts()
    IDelete intLost;
    IDelete intCall;
    CONNECT intLost WITH trapLost;
    ISignalDI di1,1,intLost;
    CONNECT intCall WITH trapCall;
    ISignalDI di2,high,intCall;
    CONNECT intLevel WITH trapLevel;
    IPers nLevel,intLevel;
ENDPROC

! 380 mm at 100 mm/s; the handler goes back and tries once more
PROC transfer()
    VAR robtarget pNow;
    TPWrite "transfer";
    MoveL pRight,v100,fine,tCup;
    TPWrite "part delivered";
ERROR
    IF ERRNO=ERR_PARTLOST THEN
        pNow:=CRobT(\Tool:=tCup\WObj:=wobj0);
        yWhereLost:=pNow.trans.y;
        nLost:=nLost+1;
        TPWrite "part lost, attempt "\Num:=nLost;
        MoveL pLeft,v500,fine,tCup;
        IF nLost<2 RETRY;
        RAISE;
    ENDIF
ENDPROC

! calls that come while interrupts are off are not forgotten
PROC quietPart()
    IDisable;
    TPWrite "quiet";
    WaitTime 0.5;
    nCallsQuiet:=nCalls;
    IEnable;
    WaitTime 0.1;
    nCallsAfter:=nCalls;
ENDPROC

PROC levelPart()
    nLevel:=nLevel+5;
    WaitTime 0.05;
    nLevel:=nLevel-1;
    WaitTime 0.05;
ENDPROC

PROC timerPart()
    CONNECT intTick WITH trapTick;
    ITimer 0.5,intTick;
    CONNECT intOnce WITH trapOnce;
    ITimer\Single,0.3,intOnce;
    WaitTime 1.75;
    IDelete intTick;
    nTicksAsleep:=nTicks;
    WaitTime 1;
ENDPROC

TRAP trapLost
    StopMove;
    ClearPath;
    StartMove;
    RAISE ERR_PARTLOST;
ERROR
    RAISE;
ENDTRAP

TRAP trapCall
    Incr nCalls;
ENDTRAP

TRAP trapTick
    Incr nTicks;
ENDTRAP

TRAP trapOnce
    IF INTNO=intOnce Incr nOnce;
ENDTRAP

TRAP trapLevel
    nLevelSeen:=nLevelSeen*10+nLevel;
ENDTRAP
ENDMODULE
