MODULE Glue
  ! Glue bead: gun on ahead of the path, check half way, lamp at the end
  VAR triggdata trGun;
  VAR triggdata trLamp;
  VAR triggdata trCheck;
  VAR triggdata trOff;
  VAR intnum iCheck;
  VAR intnum iGun;
  VAR intnum iLamp;
  VAR clock ck;
  PERS num tCheck:=0;
  PERS num tGun:=0;
  PERS num tLamp:=0;
  PERS num tTotal:=0;
  PERS num yCheck:=0;
  PERS num nEvents:=0;
  PERS num order:=0;

  PERS tooldata tNozzle:=[TRUE,[[0,0,160],[1,0,0,0]],[0.7,[0,0,70],[1,0,0,0],0,0,0]];
  CONST robtarget pStart:=[[480,40,320],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pStop:=[[480,240,320],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC main()
    nEvents:=0;
    order:=0;
    SetDO do1,0;
    SetDO do2,0;
    SetDO do3,1;
    SetDO do4,0;
    ConfL\Off;
    ! 50 mm before the end, and the gun needs 0.1 s
    TriggEquip trGun,50,0.1\DOp:=do2,1;
    TriggIO trLamp,0\DOp:=do1,1;
    TriggIO trOff,20\Start\DOp:=do3,0;
    CONNECT iCheck WITH trapCheck;
    TriggInt trCheck,100\Start,iCheck;
    CONNECT iGun WITH trapGun;
    ISignalDO do2,1,iGun;
    CONNECT iLamp WITH trapLamp;
    ISignalDO do1,1,iLamp;

    MoveJ pStart,v1000,fine,tNozzle;
    ClkReset ck;
    ClkStart ck;
    TriggL pStop,v100,trGun\T2:=trLamp\T3:=trCheck\T4:=trOff,fine,tNozzle;
    ClkStop ck;
    tTotal:=ClkRead(ck);
    WaitTime 0.2;
    back;
    TPWrite "bead done";
    EXIT;
  ENDPROC

  ! on the way back the gun goes off, with time instead of distance, in a corner
  PROC back()
    VAR triggdata trGunOff;
    VAR triggdata trLampOff;
    TriggIO trGunOff,0.3\Time\DOp:=do2,0;
    TriggIO trLampOff,30\DOp:=do4,1;
    TriggL Offs(pStop,0,-100,0),v100,trGunOff,z10,tNozzle;
    TriggJ Offs(pStart,0,0,50),v500,trLampOff,fine,tNozzle;
    IDelete iCheck;
  ENDPROC

  TRAP trapCheck
    VAR robtarget p;
    tCheck:=ClkRead(ck);
    p:=CRobT(\Tool:=tNozzle\WObj:=wobj0);
    yCheck:=p.trans.y;
    nEvents:=nEvents+1;
    order:=order*10+1;
  ENDTRAP

  TRAP trapGun
    tGun:=ClkRead(ck);
    nEvents:=nEvents+1;
    order:=order*10+2;
  ENDTRAP

  TRAP trapLamp
    tLamp:=ClkRead(ck);
    nEvents:=nEvents+1;
    order:=order*10+3;
  ENDTRAP
ENDMODULE
