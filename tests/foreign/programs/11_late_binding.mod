MODULE JobDispatch
    !***********************************************
    !*  Jobs by name. rJob1 .. rJob4 are called by *
    !*  number, tools' routines by a string table. *
    !***********************************************
    CONST string asRoutine{4}:=["rOpen","rClose","rNoSuch","rOPEN"];
    PERS num nJob{4}:=[0,0,0,0];
    PERS num nOpened:=0;
    PERS num nClosed:=0;
    PERS num nMissing:=0;
    PERS string sLast:="";
    PERS num nSum:=0;

    PROC main()
        nOpened:=0;
        nClosed:=0;
        nMissing:=0;
        nSum:=0;
        rAllNames;
        rAllJobs;
        rWithArguments;
        rTwoModules;
        TPWrite "missing: "\Num:=nMissing;
        EXIT;
    ENDPROC

    PROC rAllNames()
        FOR i FROM 1 TO Dim(asRoutine,1) DO
            %asRoutine{i}%;
        ENDFOR
    ERROR
        IF ERRNO=ERR_REFUNKPRC THEN
            nMissing:=nMissing+1;
            TPWrite "no such routine";
            TRYNEXT;
        ENDIF
    ENDPROC

    ! 1, 3, then 9 which nobody wrote
    PROC rAllJobs()
        VAR num list{3}:=[1,3,9];
        FOR i FROM 1 TO 3 DO
            CallByVar "rJob",list{i};
        ENDFOR
        %"rJob"+NumToStr(2,0)%;
    ERROR
        IF ERRNO=ERR_REFUNKPRC OR ERRNO=ERR_CALLPROC THEN
            nMissing:=nMissing+1;
            TRYNEXT;
        ENDIF
    ENDPROC

    PROC rWithArguments()
        VAR string sName;
        VAR num nResult:=1;
        sName:="rAdd";
        %sName% 3,4,nResult;
        nSum:=nResult;
        sName:="r"+"Add";
        %sName% nResult,10,nResult;
        nSum:=nSum*100+nResult;
        %"rSay"% "late";
    ENDPROC

    PROC rTwoModules()
        %"JobLibrary:rFromLibrary"%;
    ENDPROC

    PROC rOpen()
        nOpened:=nOpened+1;
    ENDPROC

    PROC rClose()
        nClosed:=nClosed+1;
    ENDPROC

    PROC rJob1()
        nJob{1}:=nJob{1}+1;
    ENDPROC

    PROC rJob2()
        nJob{2}:=nJob{2}+1;
    ENDPROC

    PROC rJob3()
        nJob{3}:=nJob{3}+1;
        rJob1;
    ENDPROC

    PROC rAdd(num a,num b,INOUT num result)
        result:=a+b;
    ENDPROC

    PROC rSay(string sText)
        sLast:=sText;
        TPWrite sText;
    ENDPROC
ENDMODULE
