%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%

MODULE Schweissen
!---------------------------------------------------------------
! Schweisszelle Halle 3, Naehte fuer Halter links
! Ersteller: H. Brandl
!---------------------------------------------------------------

RECORD nahtdaten
    string bezeichnung;
    speeddata tempo;
    num laenge_soll;
    bool ist_bogen;
ENDRECORD

TASK PERS tooldata tBrenner:=[TRUE,[[0,0,160],[1,0,0,0]],[2,[10,0,50],[1,0,0,0],0,0,0]];
TASK PERS wobjdata wVorr:=[FALSE,TRUE,"",[[450,150,300],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];

CONST nahtdaten naht{3}:=[["gerade",[50,500,5000,1000],100,FALSE],
                          ["bogen",[50,500,5000,1000],157.0796,TRUE],
                          ["zeit",[1000,500,5000,1000],100,FALSE]];

! alle Punkte bezogen auf die Mitte des Bogens
CONST robtarget pAnfang:=[[-100,-50,0],[0,0,1,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
CONST robtarget pBogenStart:=[[0,-50,0],[0,0,1,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
CONST robtarget pBogenMitte:=[[50,0,0],[0,0,1,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
CONST robtarget pBogenEnde:=[[0,50,0],[0,0,1,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];

VAR clock uhr;
VAR num zeit{3};
VAR robtarget pIst;
PERS num fertig:=0;

PROC main()
    ConfL\Off;
    ConfJ\Off;
    AccSet 100,100;
    fertig:=0;
    MoveJ Offs(pAnfang,0,0,50),v1000,z10,tBrenner\WObj:=wVorr;
    MoveL pAnfang,v200,fine,tBrenner\WObj:=wVorr;
    Naht1;
    Naht2;
    Naht3;
    Abfahren;
    TPWrite "Naehte: "+NumToStr(fertig,0);
    EXIT;
ENDPROC

! gerade Naht, Lichtbogen do2
PROC Naht1()
    Lichtbogen TRUE;
    ClkReset uhr;
    ClkStart uhr;
    MoveL pBogenStart,naht{1}.tempo,fine,tBrenner\WObj:=wVorr;
    ClkStop uhr;
    zeit{1}:=ClkRead(uhr);
    Lichtbogen FALSE;
    Melden 1;
ENDPROC

! Halbkreis
PROC Naht2()
    VAR num i:=2;
    Lichtbogen TRUE;
    ClkReset uhr;
    ClkStart uhr;
    MoveC pBogenMitte,pBogenEnde,naht{i}.tempo,fine,tBrenner\WObj:=wVorr;
    ClkStop uhr;
    zeit{i}:=ClkRead(uhr);
    Lichtbogen FALSE;
    pIst:=CRobT(\Tool:=tBrenner \WObj:=wVorr);
    Melden i;
ENDPROC

! Rueckweg mit vorgegebener Zeit, \T schlaegt das Tempo
PROC Naht3()
    ClkReset uhr;
    ClkStart uhr;
    MoveL Offs(pBogenEnde,-100,0,0),naht{3}.tempo\T:=2,fine,tBrenner\WObj:=wVorr;
    ClkStop uhr;
    zeit{3}:=ClkRead(uhr);
    Melden 3;
ENDPROC

PROC Lichtbogen(bool ein)
    IF ein THEN
        SetDO do2,1;
    ELSE
        SetDO do2,0;
    ENDIF
ENDPROC

PROC Melden(num nr)
    VAR string art;
    IF naht{nr}.ist_bogen THEN
        art:="C";
    ELSE
        art:="L";
    ENDIF
    TPWrite "Naht "+NumToStr(nr,0)+" ("+naht{nr}.bezeichnung+") "+art+" "+NumToStr(naht{nr}.laenge_soll,1);
    fertig:=fertig+1;
ENDPROC

PROC Abfahren()
    ! ein Bogen mit Zone, dann hoch
    MoveL Offs(pBogenEnde,-100,0,40),v300,z5,tBrenner\WObj:=wVorr;
    MoveC Offs(pBogenEnde,-75,-25,40),Offs(pBogenEnde,-50,0,40),v200,z10,tBrenner\WObj:=wVorr;
    MoveL Offs(pBogenEnde,-50,0,100),v500,fine,tBrenner\WObj:=wVorr;
ENDPROC
ENDMODULE
