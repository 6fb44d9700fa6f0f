MODULE Bedienung
    ! Menü für den Einrichter, Sprache der Tasten: Deutsch
    ! (Latin-1, wie vom Editor der Station gespeichert)

    CONST string leer:="";
    VAR num taste;
    VAR num wert;
    PERS string verlauf{8}:=["","","","","","","",""];
    PERS num schritte:=0;
    PERS num tempo:=100;
    PERS bool greifer_auf:=FALSE;

    PROC main()
        schritte:=0;
        tempo:=100;
        FOR i FROM 1 TO Dim(verlauf,1) DO
            verlauf{i}:=leer;
        ENDFOR
        TPErase;

    hauptmenue:
        TPReadFK taste,"Hauptmenü","Greifer","Tempo","Zählen",leer,"Ende";
        TEST taste
        CASE 1:
            GOTO greifermenue;
        CASE 2:
            GOTO tempo_eingeben;
        CASE 3:
            zaehlen;
            GOTO hauptmenue;
        CASE 5:
            GOTO ende;
        DEFAULT:
            merken "falsch";
            GOTO hauptmenue;
        ENDTEST

    greifermenue:
        TPReadFK taste,"Greifer","Auf","Zu",leer,leer,"Zurück";
        IF taste=1 OR taste=2 THEN
            greifer_auf:=(taste=1);
            IF greifer_auf THEN
                SetDO do3,1;
                merken "auf";
            ELSE
                SetDO do3,0;
                merken "zu";
            ENDIF
            GOTO greifermenue;
        ENDIF
        GOTO hauptmenue;

    tempo_eingeben:
        TPReadNum wert,"Tempo 1-100 ?";
        IF wert<1 OR wert>100 THEN
            merken "ungueltig "+NumToStr(wert,1);
            GOTO tempo_eingeben;
        ENDIF
        tempo:=wert;
        merken "tempo "+NumToStr(tempo,1);
        GOTO hauptmenue;

    ende:
        merken "ende";
        EXIT;
    ENDPROC

    PROC merken(string was)
        schritte:=schritte+1;
        verlauf{schritte}:=was;
        TPWrite "* "+was;
    ENDPROC

    ! zählt mit einer Sprungmarke statt einer Schleife
    PROC zaehlen()
        VAR num n:=0;
        VAR string zeile:="";
    nochmal:
        n:=n+1;
        TEST n
        CASE 1,3,5,7,9:
            zeile:=zeile+"u";
        CASE 2,4,6:
            zeile:=zeile+"g";
        DEFAULT:
            zeile:=zeile+"-";
        ENDTEST
        IF n<9 GOTO nochmal;
        merken zeile;
    ENDPROC
ENDMODULE
