MODULE Robot
  ! the robot's half: two orders, then waits for the lamp
  PERS num order{3};
  PERS bool stopOrder;
  VAR num t:=0;
  VAR clock ck;

  PROC main()
    stopOrder:=FALSE;
    WaitTime 0.3;
    order:=[1,5,5];
    WaitTime 0.2;
    order:=[2,order{2}+1,order{3}*2];
    WaitUntil stopOrder\MaxTime:=2;
    TPWrite "orders taken";
    ClkStart ck;
    WaitDO do7,1\MaxTime:=5;
    t:=ClkRead(ck);
    WaitDO do7,0;
    TPWrite "lamp on and off";
    Stop;
    TPWrite "never";
  ENDPROC
ENDMODULE
