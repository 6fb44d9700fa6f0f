MODULE JobLibrary
    ! local data of one name in two modules do not meet
    LOCAL VAR num nCount:=5;
    PERS num nLibrary:=0;

    LOCAL PROC rFromLibrary()
        nCount:=nCount+1;
        nLibrary:=nCount;
    ENDPROC
ENDMODULE
