MODULE Frames
  ! Work object with user and object frame; pose arithmetic by hand and by controller
  PERS tooldata tPointer:=[TRUE,[[0,0,160],[1,0,0,0]],[0.5,[0,0,60],[1,0,0,0],0,0,0]];
  PERS tooldata tAngled:=[TRUE,[[50,0,120],[0.9659258,0,0.258819,0]],[0.5,[0,0,60],[1,0,0,0],0,0,0]];
  ! uframe is turned 90 degrees about z, oframe shifted along it
  PERS wobjdata wTable:=[FALSE,TRUE,"",[[400,100,300],[0.70710678,0,0,0.70710678]],[[50,0,0],[1,0,0,0]]];

  ! in wTable: points down in the world
  CONST robtarget pMark:=[[30,-20,0],[0,0.70710678,0.70710678,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBase:=[[450,150,350],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  VAR robtarget pBack;
  VAR robtarget pAngled;
  VAR robtarget pSeen;
  VAR jointtarget jMark;
  VAR jointtarget jNow;
  VAR pose psFrame;
  VAR pose psMark;
  VAR pose psOne;
  VAR pose psSame;
  PERS pos posWorld:=[0,0,0];
  PERS pos posLocal:=[0,0,0];
  PERS pos posSum:=[0,0,0];
  PERS num nDot:=0;
  PERS num nLength:=0;
  PERS num nJointError:=-1;
  PERS num nAngles{3}:=[0,0,0];
  PERS orient oTurn:=[1,0,0,0];
  PERS bool bOut:=FALSE;

  PROC main()
    ConfL\Off;
    ConfJ\Off;
    frameMath;
    vectors;
    roundTrip;
    angled;
    MoveL Offs(pMark,0,0,60),v300,fine,tPointer\WObj:=wTable;
    pSeen:=CRobT(\Tool:=tool0\WObj:=wobj0);
    outOfReach;
    EXIT;
  ENDPROC

  PROC frameMath()
    psFrame:=PoseMult(wTable.uframe,wTable.oframe);
    psMark.trans:=pMark.trans;
    psMark.rot:=pMark.rot;
    psSame:=PoseMult(psFrame,psMark);
    posWorld:=psSame.trans;
    psOne:=PoseMult(psFrame,PoseInv(psFrame));
    posLocal:=PoseVect(PoseInv(psFrame),posWorld);
  ENDPROC

  PROC vectors()
    VAR pos a:=[1,2,2];
    VAR pos b:=[0,3,-1];
    posSum:=2*a+b*3-[1,0,0];
    nDot:=DotProd(a,b);
    nLength:=VectMagn(a);
    oTurn:=OrientZYX(90,0,0)*OrientZYX(90,0,0);
    nAngles{1}:=EulerZYX(\Z,OrientZYX(30,20,10));
    nAngles{2}:=EulerZYX(\Y,OrientZYX(30,20,10));
    nAngles{3}:=EulerZYX(\X,OrientZYX(30,20,10));
  ENDPROC

  PROC roundTrip()
    VAR num d;
    jMark:=CalcJointT(pMark,tPointer\WObj:=wTable);
    pBack:=CalcRobT(jMark,tPointer\WObj:=wTable);
    MoveAbsJ jMark,v1000,fine,tPointer;
    pSeen:=CRobT(\Tool:=tPointer\WObj:=wTable);
    jNow:=CJointT();
    nJointError:=Abs(jNow.robax.rax_1-jMark.robax.rax_1)+Abs(jNow.robax.rax_2-jMark.robax.rax_2);
    nJointError:=nJointError+Abs(jNow.robax.rax_3-jMark.robax.rax_3)+Abs(jNow.robax.rax_5-jMark.robax.rax_5);
    TPWrite "mark "+NumToStr(Round(pSeen.trans.x),0)+" "+NumToStr(Round(pSeen.trans.y),0);
  ENDPROC

  ! the same tip pose with another tool
  PROC angled()
    MoveJ pBase,v1000,fine,tAngled;
    pAngled:=CRobT(\Tool:=tAngled\WObj:=wobj0);
    pSeen:=CRobT(\Tool:=tool0);
    MoveL RelTool(pBase,0,0,-30\Rz:=15),v300,fine,tAngled;
  ENDPROC

  PROC outOfReach()
    VAR jointtarget j;
    bOut:=FALSE;
    j:=CalcJointT(Offs(pBase,2000,0,0),tPointer);
  ERROR
    bOut:=TRUE;
    TRYNEXT;
  ENDPROC
ENDMODULE
