%%%
VERSION:1
LANGUAGE:ENGLISH
%%%
! old program, do not touch!!! (everybody has)


  mODULE Ugly_01   ! comment behind the name
	! ###
Const Num  nHalf:=.5 ;const num nMilli:=1E-3;
	PERS num nRes{10}:=[0,0,0,0,0,0,0,0,0,0];  ! results
pers string sTrace:="";
VAR bool bFlag;VAR num nCnt;

proc  Main( )
nCnt:=0; sTrace:="";
  	nRes{1}:=nHalf+nMilli*1000 ;  nRes{2}:= - 3 + -.25;
nRes{3}:=2+3*4-10/4;
	nRes{4}:=- nHalf*4;
rSub1(5);
rSub1 7;
rSub2 (2),(3);
	If nCnt=12 Incr nCnt;
	IF Not bFlag nCnt:=nCnt+100;
if (nCnt>112) and not (nCnt<>113) then sTrace:=sTrace+"a"; endif
	IF bFlag=FALSE THEN ! empty body
	ELSEIF TRUE THEN
		sTrace:=sTrace+"never";
	ELSE
	ENDIF
WHILE nCnt>110 do nCnt:=nCnt-1; endwhile
For i From 3 To 1 Step -1 Do sTrace:=sTrace+NumToStr(i,0); EndFor
FOR i FROM 1 TO 0 STEP 1 DO
sTrace:=sTrace+"never";
ENDFOR
	TEST nCnt
! a comment where only cases may stand
	CASE 1,2 : sTrace:=sTrace+"x";
	case 110 :
	Case 111: sTrace:=sTrace+"never";
	DEFAULT : sTrace:=sTrace+"never";
	EndTest
Jump;
	nRes{5}:=fTwice(nRes{1})+fTwice ( 2 );
nRes{6}:=sArr{2,3}+SARR{1,1};
nRes{7}:=nLate;
	sTrace:=sTrace+sQuote;
nRes{8}:=StrLen("\0A\0D\\""");
	TPWrite sTrace+"!";  TPWrite("done");
bFlag:=nRes{1}=1.5;
   IF bFlag THEN
   nRes{9}:=1; ELSE nRes{9}:=2; ENDIF
reg1:=1;reg1:=reg1+1; nRes{10}:=reg1;
EXIT;
endproc
! ------- data between routines -----------
VAR num sArr{2,3}:=[[1,2,3],
	[4,5,   ! five
	6]];
Local Const String sQuote:="""q""";

PROC Jump()
	VAR num n:=0;
again:
	n:=n+1;
	IF n>=3 goto out;
	GOTO again;
	sTrace:=sTrace+"never";
out:
	sTrace:=sTrace+"j"+NumToStr(n,0);
	If n=3 Goto skipall;
	sTrace:=sTrace+"never";
skipall:
EndProc

PERS num nLate:=77;

LOCAL PROC rSub1(num a) nCnt:=nCnt+a; ENDPROC

	Local   FUNC	num fTwice(num a)
	return a*2;
	EndFunc

PROC rSub2(num a,num b)
	IF a>b THEN RETURN; ENDIF
	sTrace:=sTrace+"s";
	RETURN;
	sTrace:=sTrace+"never";
ERROR
	TRYNEXT;
ENDPROC

! half written by the next shift
PROC rNewJob()
	<SMT>
	IF <EXP> THEN
		<SMT>
	ENDIF
	MoveL <EXP>,v100,fine,tool0;
	nCnt:=<EXP>;
ENDPROC

Proc rEmpty()
endproc
Endmodule
some text that an editor left behind
