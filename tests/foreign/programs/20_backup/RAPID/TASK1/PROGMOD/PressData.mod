MODULE PressData
  CONST robtarget pPress:=[[0,0,0],[0,0,1,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
  CONST robtarget pOut:=[[60,90,20],[0,0,1,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
  CONST jointtarget jWide:=[[15,0,10,0,60,385],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
  PERS bool requestCheck:=FALSE;
  PERS num checkResult:=0;
  PERS bool lampSeen:=FALSE;
ENDMODULE
