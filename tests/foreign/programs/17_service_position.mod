MODULE ServicePos
! ########## service request during production ##########
! di1 brings the robot to the service position and, when the operator
! confirms on di2, back to where it was; production then goes on.

VAR intnum iService;
PERS num nServices:=0;
PERS num nLegs:=0;
PERS pos posLeft:=[0,0,0];
PERS pos posReturned:=[0,0,0];
PERS pos posService:=[0,0,0];

PERS tooldata toolTip:=[TRUE,[[0,0,160],[1,0,0,0]],[1,[0,0,80],[1,0,0,0],0,0,0]];
PERS robtarget pService:=[[420,60,560],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

LOCAL CONST robtarget pA:=[[430,60,340],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
LOCAL CONST robtarget pB:=[[430,240,340],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
LOCAL CONST robtarget pC:=[[520,240,340],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

PROC main()
    nServices:=0;
    nLegs:=0;
    IDelete iService;
    CONNECT iService WITH trService;
    ISignalDI di1,1,iService;
    ISleep iService;
    ConfL\Off;
    MoveJ pA,v1000,fine,toolTip\WObj:=wobj0;
    IWatch iService;
    TPWrite "production";
    Leg pB;
    Leg pC;
    Leg pA;
    TPWrite "production done";
    EXIT;
ENDPROC

PROC Leg(robtarget pTo)
    MoveL pTo,v100,fine,toolTip\WObj:=wobj0;
    nLegs:=nLegs+1;
ENDPROC

TRAP trService
    VAR robtarget pHere;
    VAR robtarget pNow;
    StopMove;
    StorePath;
    pHere:=CRobT(\Tool:=toolTip\WObj:=wobj0);
    posLeft:=pHere.trans;
    MoveL Offs(pHere,0,0,50),v300,z5,toolTip\WObj:=wobj0;
    MoveJ pService,v1000,fine,toolTip\WObj:=wobj0;
    pNow:=CRobT(\Tool:=toolTip\WObj:=wobj0);
    posService:=pNow.trans;
    TPWrite "service, confirm on di2";
    WaitDI di2,1;
    Incr nServices;
    MoveJ Offs(pHere,0,0,50),v1000,z5,toolTip\WObj:=wobj0;
    MoveL pHere,v300,fine,toolTip\WObj:=wobj0;
    pNow:=CRobT(\Tool:=toolTip\WObj:=wobj0);
    posReturned:=pNow.trans;
    RestoPath;
    StartMove;
ENDTRAP
ENDMODULE
